"""The laws of a mixture: scaling, interpolation in R*, the folder and the export."""

import csv
import json
import math
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from restitution.case.case_file import parse_case
from restitution.curve.interpolation import RatioCurve
from restitution.errors import CaseError
from restitution.laws.from_results import bare_law
from restitution.laws.law_files import read_laws
from restitution.mixtures.family import families
from restitution.mixtures.mixture_file import parse_mixture
from restitution.mixtures.scaling import FamilyLaws
from restitution.results.writer import ResultsFolder
from restitution.runs.run import run_case
from restitution.theory import FirstYield
from tolerance import approx

STUDIES = Path(__file__).parents[2] / "evidence" / "mixture"


def law_at(family, radius, folder):
    """The law of `family` at a reduced radius (m), computed directly."""
    text = "total_error = false\n" + family.case(radius)
    run_case(parse_case(text), text, folder, ResultsFolder(folder / f"{family.name} {radius}"))
    return bare_law(folder / f"{family.name} {radius}")


@pytest.fixture
def smooth(mixture_text):
    rough = (
        'roughness = { kind = "gaussian", rms = "0.05 um", correlation_length = "4 um", seed = 1 }'
    )
    grid = '[grid]\nnodes = 64\nspacing = "0.6 um"\nrefine = 1\n'
    return parse_mixture(mixture_text((rough, ""), (grid, "")))


def test_smooth_spheres_obey_the_scaling_law(smooth, tmp_path):
    family = families(smooth)[0]
    small, large = (law_at(family, radius, tmp_path) for radius in (25e-6, 75e-6))
    assert small.column("velocity") == approx(large.column("velocity"), rel=1e-3)
    # The grid is that of the largest contact, so that smaller ones have other cells over them.
    assert small.column("ratio") == approx(large.column("ratio"), rel=0.01)
    scaled = small.column("force") / small.radius**2
    assert scaled == approx(large.column("force") / large.radius**2, rel=0.01)


def test_unlike_spheres_take_their_velocities_from_equal_work(smooth, tmp_path):
    family = families(smooth)[0]
    pair = next(
        each
        for each in family.pairs
        if (each.first.radius, each.second.radius) == approx((50e-6, 150e-6), rel=1e-9)
    )
    computed = FamilyLaws(family, (law_at(family, pair.radius, tmp_path),))
    law = computed.law(pair)
    (node,) = computed.laws
    for point in law.points:
        assert point.loading_work == approx(0.5 * pair.mass * point.velocity**2, rel=1e-12)
        same_work = np.sqrt(2 * point.loading_work / node.mass)
        assert point.ratio == approx(node.curve().at(same_work), rel=1e-9)
        forces = np.log([node.column("velocity"), node.column("force")])
        assert point.force == approx(np.exp(np.interp(np.log(same_work), *forces)), rel=1e-9)


def test_smooth_spheres_with_a_size_effect_yield_at_the_pressure_of_their_radius(smooth, tmp_path):
    keys = {"yield_pressure": "0.8 GPa", "size_effect": "3 um"}
    mixture = replace(smooth, interfaces={frozenset(): {**smooth.interfaces[frozenset()], **keys}})
    family = families(mixture)[0]
    ends = (family.radii[0], family.radii[-1])
    laws = FamilyLaws(family, tuple(law_at(family, radius, tmp_path) for radius in ends))
    for pair in family.pairs:
        law = laws.law(pair)
        p_y = 0.8e9 * math.sqrt(1 + 1.5e-6 / (1.5 * 0.358**2 * pair.radius))  # half in each body
        first = FirstYield(pair.radius, law.contact_modulus, p_y)
        assert law.yield_pressure == approx(p_y, rel=1e-9)
        assert law.yield_velocity == approx(float(first.velocity(pair.mass)), rel=1e-6)


def test_one_size_effect_of_several_materials_is_refused(smooth):
    def families_with(common, **pairs):
        interfaces = {frozenset(): {"work_of_adhesion": "0 J/m^2", **common}}
        for key, table in pairs.items():
            interfaces[frozenset(key.split("_"))] = {**interfaces[frozenset()], **table}
        return families(replace(smooth, interfaces=interfaces))

    sized, own = {"size_effect": "0.4 um"}, {"size_effect": "0 um"}
    with pytest.raises(CaseError, match=r"size_effect: h\* is that of one .* alu, pmma yield"):
        families_with(sized)
    assert families_with(sized, pmma_alu=own, pmma=own, pmma_drum=own)
    assert families_with({**sized, "yield_pressure": "1 GPa"})
    assert families_with(own)


def test_the_interpolation_error_vanishes_at_computed_radii_only(mixture_text, tmp_path):
    family = families(parse_mixture(mixture_text()))[0]
    laws = tuple(law_at(family, radius, tmp_path) for radius in (25e-6, 40e-6, 75e-6))
    computed = FamilyLaws(family, laws)
    errors = {pair.radius: computed.interpolation_errors(pair) for pair in family.pairs}
    assert errors[family.radii[0]] == [0.0, 0.0, 0.0]
    between = next(radius for radius in family.radii if not computed.has(radius))
    assert min(errors[between]) > 0
    pair = next(each for each in family.pairs if each.radius == between)
    law, direct = computed.law(pair), law_at(family, between, tmp_path)
    for point in law.points:
        same_work = np.sqrt(2 * point.loading_work / direct.mass)
        assert abs(point.restitution - direct.at(same_work).restitution) < point.error


def test_the_verb(cli, refused, mixture_text, computed_mixture, tmp_path):
    file, out = tmp_path / "mixture.toml", tmp_path / "out"
    shutil.copytree(computed_mixture, out)
    file.write_text(mixture_text())
    laws = read_laws([out])
    assert len(laws) == 14
    summary = json.loads((out / "summary.json").read_text())
    assert summary["pairs"] == 14
    assert summary["curves_computed"] + summary["pairs_interpolated"] >= 12
    with open(out / "pairs.csv", newline="") as table:
        rows = list(csv.DictReader(table))
    assert len(rows) == 14 * 3
    assert {float(row["velocity_m_per_s"]) for row in rows} == {0.1, 10**-0.5, 1.0}
    first = laws[0]
    assert float(rows[0]["restitution"]) == approx(first.points[0].restitution, rel=1e-12)
    # Nothing is computed again.
    before = {path: path.stat().st_mtime_ns for path in out.glob("runs/**/curve.csv")}
    status, said, warned = cli("mixture", file, "-o", out, "--workers", "1", "--resume")
    assert status == 0
    assert "14 pairs from" in said
    assert before == {path: path.stat().st_mtime_ns for path in before}
    assert len(before) == summary["curves_computed"]
    # Each warning once, with the pairs that it concerns.
    assert len(summary["warnings"]) == 2
    assert not any("yield" in text for text in summary["warnings"])  # information, no warning
    (coarse,) = (text for text in summary["warnings"] if "nodes at the spacing" in text)
    assert coarse.startswith("9 of 14 pairs (alu+alu, alu+pmma, alu+drum): the contact radius of ")
    assert coarse.endswith("(with other numbers in other pairs)")
    assert all(warned.count(f"Warning: {text[:60]}") == 1 for text in summary["warnings"])
    assert [law.points for law in read_laws([out])] == [law.points for law in laws]
    assert "is not empty" in refused("mixture", file, "-o", out)
    file.write_text(mixture_text(("80 um", "81 um")))
    assert "holds another mixture" in refused("mixture", file, "-o", out, "--resume")
    assert cli("report", out)[0] == 0
    page = (out / "report.html").read_text()
    assert "alu on pmma" in page
    assert "14 pairs of particles and walls" in page
    export = ("export", out, "--to", "lammps", "-o", tmp_path / "input")
    assert "is outside the computed velocities" in refused(*export, "--velocity", "2 m/s")
    assert cli(*export, "--velocity", "0.3 m/s")[0] == 0
    written = {path.name for path in (tmp_path / "input").iterdir()}
    assert written >= {"restitution.lmp", "collision.in", "packing.in"}


def test_the_page_of_the_runs_names_the_reduced_radii(cli, computed_mixture, tmp_path):
    shutil.copytree(computed_mixture / "runs", tmp_path / "runs")
    assert cli("report", tmp_path / "runs")[0] == 0
    page = (tmp_path / "runs" / "report.html").read_text()
    assert "14 cases that vary pair, reduced_radius: 14 complete" in page
    for radius in ("25 um", "40 um", "37.5 um"):
        assert radius in page
    assert "3.9999999999999996e-05" not in page


def test_a_mixture_that_is_not_complete_is_refused(refused, computed_mixture, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(computed_mixture, out, ignore=shutil.ignore_patterns("laws", "summary.json"))
    export = ("export", out, "--to", "csv", "-o", tmp_path / "input")
    for verb in (("report", out), export):
        assert "the mixture is not complete; finish it with" in refused(*verb)


ADHESIVE = """
[materials.glass]
material = "glass"
radius = "20 um"
roughness = {{ kind = "measured", file = '{scan}', detrend = "tilt", extend = "mirror" }}
[interface]
yield_pressure = "hardness"
work_of_adhesion = "0.05 J/m^2"
[grid]
nodes = 24
spacing = "0.1 um"
refine = 1
[impact]
from = "0.1 m/s"
to = "0.3 m/s"
steps = 2
"""


def test_an_adhesive_mixture_with_a_scan(cli, compute_mixture, own_scan, tmp_path):
    out = compute_mixture(ADHESIVE.format(scan=own_scan), tmp_path / "out")
    (law,) = read_laws([out])
    assert law.work_of_adhesion == 0.05
    assert all(point.pull_off_force > 0 for point in law.points)
    summary = json.loads((out / "summary.json").read_text())
    (adhesion,) = (text for text in summary["warnings"] if "adhesion is not resolved" in text)
    assert adhesion.startswith("1 of 1 pairs (glass+glass): adhesion is not resolved at 2 of 2")
    assert cli("report", out)[0] == cli("report", out / "runs")[0] == 0
    export = ("export", out, "--to", "lammps", "--velocity", "0.2 m/s", "-o", tmp_path / "input")
    assert cli(*export)[0] == 0
    assert "pull-off force" in (tmp_path / "input" / "restitution_lammps.txt").read_text()


def test_the_stored_blind_check_holds():
    with open(STUDIES / "mixture_blind.csv", newline="") as table:
        rows = list(csv.DictReader(table))
    held = [
        abs(float(row["restitution_interpolated"]) - float(row["restitution_computed"]))
        <= float(row["error"]) + 1e-5
        for row in rows
    ]
    assert len(held) >= 60
    assert sum(held) >= 0.95 * len(held)


def test_the_error_of_an_interpolated_law_is_the_sum_of_its_parts(mixture_text, tmp_path):
    """Errors of the two computed laws beside it, and of the interpolation at three velocities."""
    family = families(parse_mixture(mixture_text()))[0]
    laws = tuple(law_at(family, radius, tmp_path) for radius in (25e-6, 40e-6, 75e-6))
    computed = FamilyLaws(family, laws)
    pair = next(each for each in family.pairs if not computed.has(each.radius))
    curves = [
        RatioCurve(
            np.array([law.radius for law in laws]),
            np.array([law.curve().at(scaled(law, V, pair)) for law in laws]),
            adhesive=False,
        )
        for V in family.mixture.velocities
    ]
    points = computed.law(pair).points
    assert len(points) == len(curves) > 2
    for k, (point, V) in enumerate(zip(points, family.mixture.velocities, strict=True)):
        after, t = curves[k].interval(pair.radius)
        beside = [law.at(scaled(law, V, pair)).error for law in laws[after - 1 : after + 1]]
        ratio = curves[k].at(pair.radius)
        off = max(curve.error(pair.radius) for curve in curves[max(k - 1, 0) : k + 2])
        ends = np.sqrt(np.clip([ratio - off, ratio, ratio + off], 0, 1))
        between = np.diff(ends).max()
        assert point.error == approx((1 - t) * beside[0] + t * beside[1] + between, rel=1e-9)
        assert computed.interpolation_errors(pair)[k] == approx(between, rel=1e-9)


def scaled(law, V, pair):
    """The velocity at which `law` has the work over R*³ of the pair, within its range."""
    velocity = V * np.sqrt(pair.mass / pair.radius**3 / (law.mass / law.radius**3))
    return min(max(velocity, law.lowest), law.highest)


def test_pairs_with_a_wall_lose_energy_to_waves(computed_mixture):
    for law in read_laws([computed_mixture]):
        for point in law.points:
            assert point.factors["plate"] == point.factors["viscosity"] == 1.0
            assert point.quasi_static * point.factors["waves"] == approx(point.restitution)
        assert law.losses == (("waves",) if law.second.wall else ())
