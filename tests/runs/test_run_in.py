"""A case with [impacts]: its tables, surfaces, errors and law."""

import csv
import io
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomli_w

from restitution import Body, Pair, RestitutionError, open_results, read_surface, run
from restitution.case.case_file import parse_case
from restitution.dem.export import export
from restitution.laws.coverage import at_coverage, coverage_of
from restitution.laws.from_results import bare_law
from restitution.repeated.points import RepeatedImpact, SteadyState
from restitution.repeated.run_in import nominal_area
from restitution.repeated.velocities import drawn, in_turn, rayleigh
from restitution.runs.run_in import _bodies
from tolerance import approx

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")  # of a coarse grid

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
CASE = {
    "title": "run in",
    "first": {"radius": "50 um", **STEEL},
    "interface": {"yield_pressure": "1 GPa", "work_of_adhesion": "0 J/m^2"},
    "roughness": {
        "kind": "gaussian",
        "rms": "15 nm",
        "correlation_length": "1 um",
        "seed": 1,
    },
    "grid": {"nodes": 32, "spacing": "0.3 um"},
    "impact": {"velocity": ["0.1 m/s", "0.2 m/s"]},
    "impacts": {"coverage": [1, 2], "places": 3},
}


def case(**tables):
    return {**CASE, **tables}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("run-in") / "out"
    run(CASE, out=out)
    return out


def test_restitution_is_measured_at_every_coverage(folder):
    results = open_results(folder)
    points = results.run_in
    assert [round(point.coverage) for point in points] == [0, 1, 2, 0, 1, 2]
    assert [point.velocity for point in points] == [0.1] * 3 + [0.2] * 3
    for point in points:
        assert point.places == 3
        assert point.restitution_5 <= point.restitution_50 <= point.restitution_95
        parts = (
            point.places_error,
            point.solver_error,
            point.discretisation_error,
            point.surface_scatter,
        )
        largest = max(point.restitution, 1 - point.restitution)
        assert point.total_error == approx(min(np.linalg.norm(parts), largest))
    new, worn = points[0], points[2]
    assert worn.restitution > new.restitution
    assert {len(one) for one in results.impacts} == {int(points[2].impacts), int(points[5].impacts)}
    assert results.summary["run_in"]["rough"] == "both"


def test_the_final_surface_is_a_scan_for_another_case(folder):
    sequence = open_results(folder).summary["run_in"]["sequences"][1]
    first = sequence["surfaces"]["first"]
    surface = read_surface(folder / first["file"])
    assert surface.grid.nodes == (32, 32)
    assert surface.grid.spacing[0] == approx(0.3e-6)
    assert surface.height.std() == approx(first["Sq_m"], rel=1e-3)
    scan = {"kind": "measured", "file": str(folder / first["file"])}
    again = run(
        case(roughness=scan, impact={"velocity": "0.1 m/s"}, impacts={"count": 2, "places": 2}),
    )
    assert again.run_in[-1].impacts == 2


def test_a_law_at_a_coverage_has_its_distribution(folder):
    law = bare_law(folder)
    points = open_results(folder).run_in
    worn = at_coverage(law, points[1].coverage)
    assert worn.points[0].restitution == approx(points[1].restitution)
    assert worn.points[0].deviation == approx(points[1].restitution_std)
    assert worn.coverage == approx(points[1].coverage)
    new = at_coverage(law, 0)
    assert new.points[1].restitution == approx(points[3].restitution)
    between = at_coverage(law, 0.5 * points[1].coverage).points[0].restitution
    assert between == approx(0.5 * (points[0].restitution + points[1].restitution))
    (row, _) = csv.DictReader(io.StringIO(export([worn], "csv", None)["restitution.csv"]))
    assert float(row["restitution_std"]) == approx(points[1].restitution_std)
    texts = export([worn], "yade", 0.15)
    assert f", {points[1].restitution_std:.6f})" in texts["restitution_yade.py"]
    assert "that earlier impacts have covered" in texts["restitution_yade.txt"]


def test_a_law_at_a_coverage_keeps_the_other_losses(folder):
    law = bare_law(folder)
    lossy = [replace(point, factors={"waves": 0.9, "plate": 0.8}) for point in law.points]
    plain, with_losses = (at_coverage(one, 1) for one in (law, replace(law, points=tuple(lossy))))
    for without, point in zip(plain.points, with_losses.points, strict=True):
        share = 0.72 / math.prod(without.factors.values())
        assert point.restitution == approx(share * without.restitution)
        assert point.deviation == approx(share * without.deviation)


def test_laws_refuse_coverages_beyond_the_computed_ones(folder):
    law = bare_law(folder)
    with pytest.raises(RestitutionError, match="beyond the computed coverages"):
        at_coverage(law, 4)
    with pytest.raises(RestitutionError, match="one coverage only"):
        at_coverage(at_coverage(law, 1), 2)
    with pytest.raises(RestitutionError, match='"many" is not 0 or a positive number'):
        coverage_of("many")


def test_one_sequence_may_have_a_distribution_of_velocities():
    impacts = {"count": 6, "places": 2, "velocity": "0.05 m/s", "distribution": "rayleigh"}
    results = run(case(impacts=impacts, total_error=False))
    (sequence,) = results.impacts
    assert len({hit.velocity for hit in sequence}) == 6
    assert [(point.velocity, point.impacts) for point in results.run_in] == [
        (0.1, 0),
        (0.2, 0),
        (0.1, 6),
        (0.2, 6),
    ]


@pytest.mark.parametrize(
    ("more", "speeds"),
    [({}, [0.05, 0.15] * 2), ({"weights": [0, 2]}, [0.15] * 4)],
    ids=["in turn", "weighted"],
)
def test_impacts_may_alternate_with_others_or_have_weights(more, speeds):
    impacts = {"count": 4, "places": 2, "velocity": ["0.05 m/s", "0.15 m/s"], **more}
    results = run(case(impacts=impacts, total_error=False))
    (sequence,) = results.impacts
    assert [hit.velocity for hit in sequence] == speeds
    covered = [nominal_area(results_pair(), 1e9, V) / 9.6e-6**2 for V in speeds]
    assert [hit.coverage for hit in sequence] == approx(np.cumsum(covered))


def results_pair():
    ball = Body(50e-6, 210e9, 0.3, 7850)
    return Pair(ball, ball)


def test_velocities_follow_their_distribution():
    turns = in_turn([1.0, 2.0])
    assert [next(turns) for _ in range(3)] == [1.0, 2.0, 1.0]
    weighted = drawn([1.0, 3.0], [3, 1], seed=1)
    assert np.mean([next(weighted) for _ in range(4000)]) == approx(1.5, rel=0.03)
    gas = rayleigh(0.2, seed=1)
    speeds = np.array([next(gas) for _ in range(4000)])
    assert speeds.mean() == approx(0.2, rel=0.03)
    assert (speeds**2).mean() == approx(0.2**2 * 4 / np.pi, rel=0.05)
    with pytest.raises(RestitutionError, match="weights"):
        next(drawn([1.0, 3.0], [1, -1], seed=1))


def hits(restitution):
    base = dict.fromkeys((name for name in RepeatedImpact.__dataclass_fields__), 1.0)
    return [
        RepeatedImpact(**{**base, "number": k + 1.0, "coverage": 0.1 * k, "restitution": e})
        for k, e in enumerate(restitution)
    ]


def test_a_steady_state_is_told_from_a_trend():
    noise = 0.03 * np.random.default_rng(1).standard_normal(200)
    steady = SteadyState.of(hits(0.6 + noise))
    assert steady.steady
    assert not SteadyState.of(hits(0.6 + 2 * noise[:60])).steady  # too few to tell
    assert steady.restitution == approx(0.6, abs=0.01)
    assert abs(steady.restitution - 0.6) < 2 * steady.error
    rising = SteadyState.of(hits(0.3 + 0.003 * np.arange(200) + noise))
    assert not rising.steady
    assert rising.trend == approx(0.03, rel=0.2)
    assert SteadyState.of(hits(noise[:20])) is None


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"impacts": {"coverage": 0.001}}, "is less than one contact at 0.1 m/s"),
        ({"impacts": {"coverage": 1e7}}, "more than 100000"),
        ({"impacts": {"places": 4}}, "give either count or coverage"),
        ({"impacts": {"count": 3, "coverage": 1}}, "give either count or coverage"),
        (
            {"roughness": {**CASE["roughness"], "periodic": False}},
            "roughness.periodic: must be true with",
        ),
        (
            {"impacts": {"count": 3, "velocity": ["1 m/s", "2 m/s"], "weights": [1, -1]}},
            "weights: -1 is not 0 or a positive number",
        ),
        ({"impacts": {"count": 3, "velocity": "-1 m/s"}}, "impacts.velocity"),
        ({"impacts": {"count": 3, "velocity": "1 m/s", "weights": [0]}}, "are all 0"),
        ({"impacts": {"count": 3, "weights": [1]}}, "1 weights for 0 velocities"),
        ({"impacts": {"count": 3, "distribution": "rayleigh"}}, "needs one velocity"),
        ({"impacts": {"count": 3, "place": "track"}}, 'impacts.place: "track" needs a wall'),
        ({"roughness": {**CASE["roughness"], "realisations": 3}}, "roughness.realisations"),
        ({"grid": {**CASE["grid"], "refine": "auto"}}, "grid.refine: must be one number"),
        ({"grid": {**CASE["grid"], "nodes": 10}}, "grid.nodes: the grid of 3 µm is too small"),
        ({"impacts": {"count": 3, "rough": ["first", "both"]}}, 'no "both"'),
        (
            {"impacts": {"count": 3, "rough": ["first", "second"]}},
            "impacts.rough: names 2 bodies for 1 tables",
        ),
        (
            {"interface": {**CASE["interface"], "plasticity": "truncated"}},
            'interface.plasticity: "truncated" defines a single impact',
        ),
    ],
)
def test_impossible_tables_are_refused_in_one_line(tables, words):
    with pytest.raises(RestitutionError, match=words) as refused:
        parse_case(tomli_w.dumps(case(**tables)))
    assert "\n" not in str(refused.value)


def test_each_table_of_roughness_is_on_its_body():
    waves = [{**CASE["roughness"], "rms": f"{rms} nm", "seed": rms} for rms in (3, 5, 8)]
    own = {"roughness": waves, "impact": {"velocity": "0.2 m/s"}, "total_error": False}

    def rms_of(rough):
        impacts = {"count": 1, "places": 2, **({"rough": rough} if rough else {})}
        parsed = parse_case(tomli_w.dumps(case(impacts=impacts, **own)))
        return [float(surface.height.std()) for surface in _bodies(parsed, Path())]

    assert rms_of(["second", "first", "second"]) == approx([5e-9, math.hypot(3e-9, 8e-9)], rel=0.05)
    assert rms_of("first")[1] == 0
    assert rms_of("second")[0] == 0
    assert rms_of("both") == approx([3e-9, math.hypot(5e-9, 8e-9)], rel=0.05)
    assert rms_of(None) == rms_of("both")  # two equal bodies


def test_impacts_need_the_table_impact():
    tables = {key: table for key, table in CASE.items() if key != "impact"}
    with pytest.raises(RestitutionError, match=r"\[impacts\]: needs \[impact\]"):
        parse_case(tomli_w.dumps({**tables, "indentation": {"values": ["10 nm"]}}))


def test_a_scan_whose_edges_do_not_match_is_refused(tmp_path):
    np.save(tmp_path / "scan.npy", np.add.outer(np.linspace(0, 1e-7, 48), np.zeros(48)))
    scan = {"kind": "measured", "file": str(tmp_path / "scan.npy"), "size": "9.7 um"}
    with pytest.raises(RestitutionError, match=r'set roughness\.extend = "twin"'):
        run(case(roughness=scan))
