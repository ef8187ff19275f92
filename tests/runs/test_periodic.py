"""Runs of periodic cases: what is stored, and which cases are refused."""

import csv
import json
import math

import numpy as np
import pytest
import xarray as xr

import restitution as rs
from restitution.case.case_file import parse_case
from restitution.contact.prescribed.stiffness import normal_stiffness
from restitution.errors import CaseError, DomainError, OutputError
from restitution.pages.report import write_report
from restitution.plots.periodic import periodic_figures
from restitution.results.periodic import COLUMNS
from restitution.results.reader import read_run
from restitution.runs.ensemble import run_realisations
from restitution.runs.run import run_case
from restitution.theory import Persson
from tolerance import approx

CASE = """
title = "Flat bodies"
[first]
radius = "flat"
youngs_modulus = "210 GPa"
poissons_ratio = 0.25
[interface]
yield_pressure = "elastic"
[roughness]
kind = "self-affine"
rms = "0.1 um"
hurst = 0.8
shortest = "2 um"
seed = 1
[grid]
nodes = 64
spacing = "0.25 um"
periodic = true
[pressure]
from = "50 MPa"
to = "1 GPa"
steps = 3
"""
PRESSURE = CASE[CASE.index("[pressure]") :]


def run(text, folder, **more):
    (folder / "case.toml").write_text(text)
    return rs.run(folder / "case.toml", out=folder / "out", **more)


def test_a_run_stores_the_states_of_its_pressures(tmp_path):
    progress = []
    results = run(CASE, tmp_path, progress=progress.append)
    with open(tmp_path / "out" / "periodic.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == list(COLUMNS)
    assert progress == [f"{k} of 3 depths" for k in (1, 2, 3)]
    contact = parse_case(CASE).contact(tmp_path)
    for row, pressure in zip(rows, np.geomspace(50e6, 1e9, 3), strict=True):
        state = rs.solve_at_pressure(contact, float(pressure))
        assert float(row["nominal_pressure_Pa"]) == approx(pressure)
        assert float(row["mean_gap_m"]) == approx(state.mean_gap)
        assert float(row["relative_area"]) == approx(state.relative_area)
        assert float(row["stored_energy_J"]) == approx(state.stored_energy)
        assert float(row["loading_work_J"]) == approx(state.loading_work)
        assert float(row["corrected_relative_area"]) < state.relative_area
        assert float(row["stiffness_Pa_per_m"]) == approx(normal_stiffness(state), rel=1e-6)
    data = results.dataset
    assert data["nominal_pressure"].values == approx(np.geomspace(50e6, 1e9, 3))
    assert data["pressure"].values == approx(state.pressure, abs=1e-6 * state.pressure.max())
    assert data["mean_gap"].attrs["units"] == "m"
    for number, row in enumerate(rows):  # the sum of the distribution is the area and the force
        of = data.isel(depth=number)
        width = float(of["binned_pressure"][1] - of["binned_pressure"][0])
        density = of["pressure_density"].values
        assert width * density.sum() == approx(float(row["relative_area"]))
        force = width * float(density @ of["binned_pressure"].values)
        assert force == approx(float(row["nominal_pressure_Pa"]), rel=0.01)
    assert results.rows[-1]["largest_pressure_Pa"] == float(rows[-1]["largest_pressure_Pa"])
    assert float(data["mean_gap"].sel(depth=0.0, method="nearest")) == data["mean_gap"].values[0]
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary == results.summary
    assert summary["status"] == data.attrs["status"] == "complete"
    assert data.attrs["warnings"].splitlines() == summary["warnings"]
    assert summary["derived"]["reduced_pressure_Pa"] == approx(
        contact.pair.contact_modulus * contact.slope
    )
    assert repr(rs.open_results(tmp_path / "out")).endswith("50 MPa to 1 GPa")


def test_the_figures_show_the_area_beside_that_of_persson(tmp_path):
    data = run(CASE, tmp_path).dataset
    figures = dict(periodic_figures(data))
    assert list(figures) == [
        "area-pressure",
        "stiffness-pressure",
        "pressure-distribution",
        "pressure",
    ]
    stiffness = figures["stiffness-pressure"].panels[0].series[0]
    assert stiffness.y == approx(1e-15 * data["stiffness"].values)
    labels = [line.label for line in figures["pressure-distribution"].panels[0].series]
    assert labels == ["at 50 MPa", "at 223.6 MPa", "at 1 GPa", *["elastic, Persson (2001)"] * 3]
    area, gap = figures["area-pressure"].panels
    points, theory = area.series
    assert points.y == approx(100 * data["corrected_relative_area"].values)
    slope, E_star = (
        float(data.attrs[f"derived_{key}"]) for key in ("rms_slope", "contact_modulus_Pa")
    )
    persson = Persson(slope, E_star).relative_area(data["nominal_pressure"].values)
    assert theory.y == approx(100 * persson)
    assert (np.diff(gap.series[0].y) < 0).all()


@pytest.mark.parametrize(
    ("table", "depth"),
    [
        ('[indentation]\nvalues = ["60 nm", "120 nm"]\n', "indentation_m"),
        ('[load]\nvalues = ["10 mN", "0.1 N"]\n', "force_N"),
    ],
)
def test_depths_may_be_indentations_or_loads(tmp_path, table, depth):
    text = CASE.replace(PRESSURE, table).replace('"elastic"', '"4 GPa"')
    data = run(text, tmp_path).dataset
    asked = parse_case(text).depths()
    assert data[COLUMNS[depth].variable].values == approx(np.array(asked))
    assert (data["plastic_work"].values > 0).all()
    assert data.attrs["model_plasticity"] == "equilibrium"


def test_a_depth_that_cannot_be_solved_ends_the_curve(tmp_path):
    text = CASE.replace(PRESSURE, '[indentation]\nvalues = ["60 nm", "9 um"]\n')
    with pytest.raises(DomainError, match="the contact is complete at"):
        run(text, tmp_path)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["status"] == "failed"
    assert (summary["depths_asked"], summary["depths_computed"]) == (2, 1)


def test_without_a_depth_there_are_no_results(tmp_path):
    text = CASE.replace(PRESSURE, '[indentation]\nvalues = ["9 um"]\n')
    with pytest.raises(DomainError, match="the contact is complete at"):
        run(text, tmp_path)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("periodic = true", "periodic = false", r"add periodic = true to \[grid\]"),
        ('radius = "flat"', 'radius = "1 mm"', 'first.radius: must be "flat"'),
        (PRESSURE, '[impact]\nvelocity = "1 m/s"\n', "have infinite mass"),
        ("[grid]", "[unloading]\n[grid]", r"\[unloading\]: a periodic case"),
        ("[roughness]", 'work_of_adhesion = "0.1 J/m^2"\n[roughness]', r"needs \[indentation\]"),
        (
            'yield_pressure = "elastic"',
            'yield_strength = "1 GPa"',
            "needs a constant yield pressure",
        ),
        ('"elastic"', '"1 GPa"\nplasticity = "truncated"', 'and plasticity = "equilibrium"'),
        ('"elastic"', '"900 MPa"', "pressure: 1000 MPa is not below the yield pressure, 900 MPa"),
        ("periodic = true", 'periodic = true\nrefine = "auto"', "grid.refine: must be one number"),
        ("seed = 1", "seed = 1\nrealisations = 2", "realisations: a periodic case has one"),
        ("seed = 1", "seed = 1\nperiodic = false", "roughness.periodic: must be true"),
        (CASE[CASE.index("[roughness]") : CASE.index("[grid]")], "", "roughness: is missing"),
    ],
)
def test_cases_that_are_refused(old, new, words):
    assert old in CASE
    with pytest.raises(CaseError, match=words):
        parse_case(CASE.replace(old, new))


def test_only_a_run_takes_a_periodic_case(tmp_path):
    from restitution.results.writer import ResultsFolder
    from restitution.runs.convergence import run_convergence
    from restitution.sweeps.sweep import parse_study

    case = parse_case(CASE)
    for start in (run_case, run_convergence):
        with pytest.raises(CaseError, match=r"grid\.periodic: a periodic contact has no restitut"):
            start(case, CASE, tmp_path, ResultsFolder(tmp_path / "other"))
    with pytest.raises(CaseError, match=r"grid\.periodic"):
        parse_study(CASE + "[sweep.roughness]\nseed = [1, 2]\n")
    run_realisations(case, CASE, tmp_path, out := ResultsFolder(tmp_path / "out"))
    with pytest.raises(OutputError, match="a periodic contact, which has no restitution"):
        read_run(out.path)


def test_a_scan_whose_edges_do_not_match_is_warned_of(tmp_path):
    heights = rs.generate_surface(
        rs.Grid(64, 0.25e-6),
        kind="gaussian",
        rms=50e-9,
        correlation_length=2e-6,
        seed=1,
        periodic=False,
    ).height
    np.save(tmp_path / "scan.npy", heights)
    start, end = CASE.index("[roughness]"), CASE.index("[grid]")
    measured = '[roughness]\nkind = "measured"\nfile = "scan.npy"\nsize = "16 um"\n'
    with pytest.warns(UserWarning, match=r"roughness\.file: the opposite edges"):
        run((CASE[:start] + measured + CASE[end:]).replace("50 MPa", "0.5 GPa"), tmp_path)


def test_the_page_of_a_periodic_contact(tmp_path):
    out = run(CASE, tmp_path).folder
    page = write_report(out).read_text()
    for words in (
        "Contact area and mean gap",
        "Normal stiffness",
        "Distribution of the contact pressure",
        "Persson (2001)",
        "1 GPa",
    ):
        assert words in page
    assert "unloading work" not in page


def test_the_page_of_results_of_earlier_versions(tmp_path):
    out = run(CASE, tmp_path).folder
    with xr.open_dataset(out / "results.nc") as stored:
        old = stored.load()
    bare = old.drop_vars(["stiffness", "pressure_density", "binned_pressure", "depth"])
    (out / "results.nc").unlink()
    bare.reset_coords("nominal_pressure").to_netcdf(out / "results.nc")
    (out / "SHA256SUMS").unlink()
    page = write_report(out).read_text()
    assert "Contact area and mean gap" in page
    assert "Normal stiffness" not in page


def test_complete_contact_has_no_stiffness(tmp_path):
    data = run(CASE.replace('"1 GPa"', '"100 GPa"'), tmp_path).dataset
    assert data["relative_area"].values[-1] == 1
    assert np.isfinite(data["stiffness"].values).tolist() == [True, True, False]
    assert "stiffness-pressure" in dict(periodic_figures(data))


def test_the_derived_quantities_have_no_radius(tmp_path):
    from restitution.case.derived import deepest_indentation, derived_quantities

    case = parse_case(CASE)
    contact = case.contact(tmp_path)
    found = derived_quantities(case, contact)
    assert "reduced_radius_m" not in found
    assert found["mean_gap_at_first_touch_m"] == approx(float(contact.gap.mean()))
    assert found["nominal_area_m2"] == approx(256e-12)
    assert math.isnan(deepest_indentation(case))
