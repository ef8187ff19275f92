"""The law of a run: its content, its errors for the user, and values between its points."""

import csv
import json
import math
import shutil
from dataclasses import asdict, replace

import numpy as np
import pytest

from restitution.dem.fits import fit_law, fitted_laws
from restitution.errors import CaseError, DomainError, OutputError
from restitution.laws.compact_fit import compact_fit
from restitution.laws.from_results import bare_law
from restitution.laws.law import STORED_LAW
from restitution.laws.law_files import read_law, write_law
from tolerance import approx

HEAD = """
title = "A small pair"
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.25
density = "7850 kg/m^3"
"""
GRID = """
[grid]
nodes = 96
spacing = "0.8 um"
[unloading]
curves = 1
"""
PLASTIC = '[interface]\nyield_pressure = "750 MPa"\n'


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Run a case once; return its results folder."""
    from restitution.case.case_file import parse_case
    from restitution.results.writer import ResultsFolder
    from restitution.runs.ensemble import run_realisations

    known = {}

    def run(text):
        if text not in known:
            out = tmp_path_factory.mktemp("run") / "out"
            run_realisations(parse_case(text), text, out.parent, ResultsFolder(out))
            known[text] = out
        return known[text]

    return run


@pytest.fixture(scope="module")
def truncated(runs):
    """A smooth pair with Thornton and Ning's pressure, far beyond yield."""
    plastic = '[interface]\nyield_pressure = "750 MPa"\nplasticity = "truncated"\n'
    impact = '[impact]\nfrom = "0.02 m/s"\nto = "1 m/s"\nsteps = 8\n'
    return runs(HEAD + plastic + impact + GRID)


@pytest.fixture(scope="module")
def rough(runs):
    roughness = (
        '[roughness]\nkind = "gaussian"\nrms = "0.1 um"\ncorrelation_length = "8 um"\nseed = 1\n'
    )
    depths = '[indentation]\nfrom = "20 nm"\nto = "2 um"\nsteps = 7\n'
    return runs(HEAD + PLASTIC + roughness + depths + GRID)


def test_the_points_are_those_of_the_run(rough):
    law = bare_law(rough)
    with open(rough / "curve.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    for name, column in (
        ("velocity", "impact_velocity_m_per_s"),
        ("restitution", "restitution"),
        ("loading_work", "loading_work_J"),
        ("force", "force_N"),
    ):
        assert law.column(name).tolist() == [float(row[column]) for row in rows]
    assert [point.resolved for point in law.points] == [row["resolved"] == "true" for row in rows]
    assert (law.lowest, law.highest) == (law.points[0].velocity, law.points[-1].velocity)
    summary = json.loads((rough / "summary.json").read_text())
    assert law.warnings == tuple(summary["warnings"])
    said = asdict(law.conventions)
    error = said.pop("restitution_error")
    assert error.startswith(
        "solver, grid, difference of this surface from the mean of 8 surfaces; not: the model"
    )
    assert said == summary["conventions"]


def test_the_law_holds_at_an_end_that_the_run_met_within_its_tolerance(rough):
    """A run meets the velocities of its case within 1e-4, and the law is asked for these."""
    law = bare_law(rough)
    assert law.at(law.lowest * (1 - 1e-4)).restitution == law.points[0].restitution
    assert law.at(law.highest * (1 + 1e-4)).restitution == law.points[-1].restitution
    for beyond in (law.lowest * (1 - 2e-4), law.highest * (1 + 2e-4)):
        with pytest.raises(DomainError, match="nothing is extrapolated"):
            law.at(beyond)


def test_at_a_point_the_law_is_the_point_and_between_points_it_is_between(rough):
    law = bare_law(rough)
    for before, point in zip(law.points, law.points[1:], strict=False):
        at = law.at(point.velocity)
        assert (at.restitution, at.error) == (point.restitution, point.error)
        middle = law.at(math.sqrt(before.velocity * point.velocity))
        ends = sorted((before.restitution, point.restitution))
        assert ends[0] <= middle.restitution <= ends[1]
        assert middle.error >= 0.5 * (
            before.error + point.error
        )  # linear part and interpolation error
        assert middle.resolved == (before.resolved and point.resolved)


@pytest.mark.parametrize("factor", [0.5, 0.999, 1.001, 2.0])
def test_nothing_is_extrapolated(rough, factor):
    law = bare_law(rough)
    velocity = factor * (law.lowest if factor < 1 else law.highest)
    with pytest.raises(DomainError, match="outside the computed velocities"):
        law.at(velocity)


def test_a_law_is_read_as_it_was_written(rough, tmp_path):
    law = fit_law(rough)
    names = {path.name for path in write_law(law, tmp_path / "law")}
    assert names == {"law.json", "table.csv", "laws.csv"}
    assert read_law(tmp_path / "law") == law
    with open(tmp_path / "law" / "table.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["restitution"]) for row in rows] == law.column("restitution").tolist()
    assert {row["end_of_contact"] for row in rows} == {law.conventions.end_of_contact}
    assert {row["yield_pressure_convention"] for row in rows} == {law.conventions.yield_pressure}
    assert all(float(row["yield_velocity_smooth_m_per_s"]) > 0 for row in rows)
    with open(tmp_path / "law" / "laws.csv", newline="") as file:
        columns = next(csv.reader(file))
    assert columns[3:] == [each.name for each in law.laws]
    with pytest.raises(OutputError, match="not empty"):
        write_law(law, tmp_path / "law")


def test_what_is_no_law(tmp_path, rough):
    with pytest.raises(OutputError, match="holds no law"):
        read_law(rough)
    (tmp_path / "law.json").write_text('{"title": 1}')
    with pytest.raises(CaseError, match="is not a law of this version"):
        read_law(tmp_path)
    with pytest.raises(OutputError, match="is already a law"):
        fit_law(tmp_path)
    (tmp_path / "law.json").unlink()
    with pytest.raises(OutputError, match="holds no results of a run"):
        fit_law(tmp_path)
    (tmp_path / "study.toml").write_text("")
    with pytest.raises(OutputError, match="is a study of many cases"):
        fit_law(tmp_path)


def test_without_density_there_is_no_law(runs):
    text = (HEAD + PLASTIC + '[indentation]\nvalues = ["1 um"]\n' + GRID).replace(
        'density = "7850 kg/m^3"\n', ""
    )
    with pytest.raises(CaseError, match="gives no density"):
        fit_law(runs(text))


def test_unresolved_points_are_kept_but_not_fitted(runs):
    """On a grid too coarse for the surface, one node carries the shallowest contacts."""
    roughness = (
        '[roughness]\nkind = "gaussian"\nrms = "0.3 um"\ncorrelation_length = "2 um"\nseed = 1\n'
    )
    depths = '[indentation]\nfrom = "5 nm"\nto = "3 um"\nsteps = 9\n'
    law = fit_law(runs(HEAD + PLASTIC + roughness + depths + GRID))
    unresolved = [point for point in law.points if not point.resolved]
    assert unresolved
    assert not law.at(unresolved[0].velocity).resolved
    assert any("not resolved" in warning for warning in law.warnings)
    assert law.fit is None or law.fit.lowest > unresolved[0].velocity


def test_the_fitted_yield_pressure_is_that_which_went_in(truncated):
    """Thornton and Ning's force is exact for truncated pressure, their unloading is not."""
    laws = {each.name: each for each in fit_law(truncated).laws}
    by_force = laws["thornton-ning-force"].parameters["yield_pressure_Pa"]
    assert by_force == approx(750e6, rel=0.01)
    by_restitution = laws["thornton-ning"].parameters["yield_pressure_Pa"]
    assert by_restitution == approx(750e6, rel=0.08)
    assert laws["thornton-ning"].rms < laws["thornton-ning-force"].rms < 0.03


def test_every_fitted_law_is_judged_by_its_own_numbers(truncated):
    law = fit_law(truncated)
    assert [each.name for each in law.laws] == [
        "constant",
        "thornton-ning-force",
        "thornton-ning",
        "walton-braun",
        "luding",
        "eepa",
        "lammps-mdr",
    ]
    e = law.column("restitution")
    for each in law.laws:
        miss = np.array(each.restitution, dtype=float) - e
        assert each.worst == approx(np.abs(miss).max(), rel=1e-9)
        assert each.rms == approx(np.sqrt(np.mean(miss**2)), rel=1e-9)
        assert each.source
        assert each.ends
    rms = {each.name: each.rms for each in law.laws}
    # A law whose e does not depend on velocity fits no better than a constant; the others do.
    assert rms["eepa"] == approx(rms["constant"], rel=0.01)
    assert rms["walton-braun"] < 0.5 * rms["constant"]
    assert rms["luding"] < 0.5 * rms["constant"]


def test_an_elastic_pair_has_nothing_to_fit(runs):
    elastic = '[interface]\nyield_pressure = "elastic"\n'
    law = fit_law(runs(HEAD + elastic + '[impact]\nvelocity = ["0.1 m/s", "0.3 m/s"]\n' + GRID))
    assert law.laws == ()
    assert law.column("restitution") == approx(1.0, abs=1e-6)
    assert law.yield_velocity is None


def test_the_mean_of_several_surfaces_has_their_interval_in_its_error(runs):
    roughness = (
        '[roughness]\nkind = "gaussian"\nrms = "0.1 um"\ncorrelation_length = "8 um"\nseed = 1\n'
        "realisations = 3\n"
    )
    out = runs(HEAD + PLASTIC + roughness + '[indentation]\nvalues = ["0.5 um", "1 um"]\n' + GRID)
    law = bare_law(out)
    with open(out / "curve.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    for point, row in zip(law.points, rows, strict=True):
        half = float(row["restitution_high"]) - float(row["restitution"])
        assert point.error >= half > 0


def test_damaged_results_are_refused(rough, tmp_path):
    def copied(name, text):
        folder = tmp_path / f"{name}-{len(list(tmp_path.iterdir()))}"
        shutil.copytree(rough, folder)
        (folder / name).write_text(text) if text is not None else (folder / name).unlink()
        return folder

    rows = (rough / "curve.csv").read_text().splitlines(keepends=True)
    with pytest.raises(OutputError, match=r"curve\.csv: is damaged"):
        bare_law(copied("curve.csv", "".join(rows[:3])))
    with pytest.raises(OutputError, match="has not ended, or was killed"):
        bare_law(copied("summary.json", None))
    for name, text in (
        ("summary.json", "{}"),
        ("summary.json", "{"),
        ("results.nc", ""),
        ("results.nc", None),
    ):
        with pytest.raises(OutputError, match=rf"{name}: (is damaged|does not exist)"):
            bare_law(copied(name, text))


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"mass": -1.0}, "mass"),
        ({"radius": 1.0}, "radius"),
        ({"mass": math.nan}, "mass"),
        ({"mass": math.inf}, "mass"),
        ({"conventions": {}}, "conventions"),
        ({"points": []}, "points"),
    ],
)
def test_a_law_that_does_not_hold_together_is_refused(law, tmp_path, change, what):
    content = json.loads(STORED_LAW.dump_json(law())) | change
    (tmp_path / "law.json").write_text(json.dumps(content))
    with pytest.raises(CaseError, match=f"is not a law of this version .*{what}"):
        read_law(tmp_path)


def test_points_that_do_not_hold_together_are_refused(law, tmp_path):
    def refused(change):
        content = json.loads(STORED_LAW.dump_json(law()))
        change(content["points"])
        (tmp_path / "law.json").write_text(json.dumps(content))
        with pytest.raises(CaseError, match="is not a law of this version"):
            read_law(tmp_path)

    refused(lambda points: points.reverse())
    refused(lambda points: points.append(points[-1]))
    refused(lambda points: points[0].update(velocity=0.0))
    refused(lambda points: points[3].update(ratio=0.01))
    refused(lambda points: points[3].update(restitution=1.5))


def test_a_law_needs_a_point():
    with pytest.raises(ValueError, match="points"):
        STORED_LAW.validate_python({"points": []})


def test_a_pair_that_always_sticks_is_said_to(law, tmp_path):
    points = tuple(replace(point, restitution=0.0, ratio=-0.5) for point in law().points)
    stuck = law(points=points, work_of_adhesion=0.1)
    assert stuck.sticks_everywhere
    assert stuck.curve().begins() is None
    assert stuck.at(0.2).restitution == 0


def test_restitution_takes_velocities_of_any_shape(law):
    found = law()
    V = np.array([[0.02, 0.3], [1.0, 10.0]])
    e = found.restitution(V)
    assert e.shape == (2, 2)
    assert e.ravel().tolist() == [found.at(v).restitution for v in V.ravel()]
    assert found.restitution(0.3) == found.at(0.3).restitution
    with pytest.raises(DomainError, match="nothing is extrapolated"):
        found.restitution([0.3, 20.0])


def test_a_law_shows_only_its_own_names(law):
    fitted = replace(law(), laws=fitted_laws(law()), fit=compact_fit(law()))
    for part in (fitted, fitted.first, fitted.points[0], fitted.fit, fitted.laws[0]):
        names = [name for name in dir(part) if not name.startswith("_")]
        assert not [name for name in names if name.startswith(("model_", "parse", "schema"))]
        assert not {"dict", "json", "copy", "construct", "validate"} & set(names)
    assert {"restitution", "at", "points"} <= set(dir(fitted))
