"""The total error of COR: its parts, and the effect of each."""

import json
import math
import re
from types import SimpleNamespace

import numpy as np
import pytest

from points import point
from restitution.case.case_file import parse_case
from restitution.contact.path import loading_path
from restitution.curve.work_curve import WorkCurve
from restitution.errors import NotConvergedError
from restitution.results.writer import ResultsFolder
from restitution.runs import depths as depths_module
from restitution.runs.companion_curves import curve_of
from restitution.runs.companions import Companions
from restitution.runs.convergence import run_convergence
from restitution.runs.ensemble import run_realisations
from restitution.runs.error_budget import (
    OmittedWaves,
    grid_error,
    scatter,
    unseen_yield,
    widened_error,
)
from tolerance import approx

PARTS = ("restitution_error", "discretisation_error", "surface_scatter", "material_error")

NONE = np.zeros(4)


def one(**more):
    values = {"median_patch_nodes": 500.0, "restitution": 0.5}
    values |= {"stored_energy": 1e-9, "plastic_work": 1e-9}
    values |= {"indentation": 1e-8, "force": 1e-3, "contact_area": 1e-12}
    return point(**values | more)


def run(text, path):
    out = ResultsFolder(path)
    summary = run_realisations(parse_case(text), text, path.parent, out)
    return out.rows, summary


def test_the_total_is_the_root_of_the_squares_within_what_cor_can_be_off():
    parts = dict(zip(PARTS, (0.01, 0.02, 0.03, math.nan), strict=True))
    assert one(**parts).combined_error == approx(math.sqrt(0.0014), rel=1e-12)
    assert one(restitution=0.9, surface_scatter=5.0).combined_error == approx(0.9, rel=1e-12)


def test_every_row_of_a_run_has_a_total_of_its_parts(case_text, tmp_path):
    rows, summary = run(case_text, tmp_path / "out")
    for each in rows:
        known = [each[name] for name in PARTS if not math.isnan(each[name])]
        assert len(known) == 3  # the case uses no library values
        assert each["discretisation_error"] > 0
        assert each["surface_scatter"] > 0
        limit = max(each["restitution"], 1 - each["restitution"])
        assert each["total_error"] == approx(min(math.hypot(*known), limit), rel=1e-12)
    assert summary["diagnostics"]["largest_total_error"] == max(
        each["total_error"] for each in rows
    )
    assert (
        "difference of this surface from the mean of 8 surfaces"
        in summary["diagnostics"]["total_error_includes"]
    )
    assert (
        "of plasticity, see model_error" in summary["diagnostics"]["total_error_does_not_include"]
    )


def test_it_can_be_left_out(case_text, tmp_path):
    rows, summary = run("total_error = false\n" + case_text, tmp_path / "out")
    assert all(math.isnan(each["total_error"]) for each in rows)
    assert summary["diagnostics"]["largest_total_error"] is None


def test_library_values_bring_their_spread(case_text, tmp_path):
    begin, end = case_text.index("[first]"), case_text.index("[roughness]")
    steel = 'first = { material = "steel", radius = "500 um" }\n'
    rows, _ = run(case_text[:begin] + steel + case_text[end:], tmp_path / "out")
    assert all(each["material_error"] > 0.005 for each in rows[2:])  # where asperities yield
    for each in rows:
        assert each["total_error"] >= min(each["material_error"], 1 - each["restitution"]) - 1e-12


def test_the_surface_error_covers_the_mean_of_other_surfaces(case_text, tmp_path):
    """The mean COR of twelve other seeds differs by less than the stated error, at every depth."""
    rows, _ = run(case_text, tmp_path / "out")
    quick = "total_error = false\n" + case_text
    found = np.array(
        [
            [
                each["restitution"]
                for each in run(quick.replace("seed = 1", f"seed = {s}"), tmp_path / f"s{s}")[0]
            ]
            for s in range(100, 112)
        ]
    )
    stated = np.array([each["surface_scatter"] for each in rows])
    off = np.abs([each["restitution"] for each in rows] - found.mean(axis=0))
    assert (off < stated).all()
    assert (stated < off + 2 * found.std(axis=0, ddof=1)).all()


def test_a_difference_that_is_zero_by_chance_makes_no_error_zero():
    work = np.geomspace(1e-9, 1e-6, 4)
    change = np.array([0.04, 0.0, 0.04, 0.04])
    error, band = grid_error(change, NONE, work, [one()] * 4, octaves=0.0)
    assert error[1] > 0.015
    assert (band == 0).all()
    for nodes, least in ((1, 0.4), (5, 0.05), (500, 1e-4)):
        unseen, _ = grid_error(NONE, NONE, work, [one(median_patch_nodes=nodes)] * 4, 0.0)
        assert (unseen > least).all()


def test_waves_beyond_the_grid_count_by_the_slope_they_have():
    work = np.geomspace(1e-9, 1e-6, 3)
    change = np.full(3, 0.02)
    without, _ = grid_error(change, NONE[:3], work, [one()] * 3, octaves=0.0)
    error, band = grid_error(change, NONE[:3], work, [one()] * 3, octaves=2.0)
    assert band == approx(np.full(3, 0.06), rel=1e-12)
    assert error == approx(np.hypot(without, 0.06), rel=1e-12)


def test_an_elastic_contact_counts_what_a_lower_yield_pressure_would_change():
    def impact(restitution):
        return WorkCurve(np.array([1e-9]), np.array([1e-9 * restitution**2]), np.zeros(1))

    class Falling:
        """COR falls by 0.1 with the yield pressure, at any work."""

        reference = impact(0.9)
        coarse = SimpleNamespace(pair=SimpleNamespace(contact_modulus=1e11))

        def weaker(self, factors):
            assert factors == approx(np.full(3, 0.6), rel=1e-12)
            return impact(0.8 + 0.1 * factors[0])

    # With p = 3/4 of the pressure ½E*(S² − S_2h²)^½ that the waves add, p/p_S = 3/5.
    waves = OmittedWaves(octaves=0.0, slope=0.13, coarser_slope=0.05, removed_slope=0.0, pixel=1e-9)
    force = 0.75 * 0.5 * 1e11 * 0.12 * 1e-12
    rows = [one(loading_work=1e-9, plastic_work=p, force=force) for p in (0.0, 1e-9, 3e-9)]
    unseen = unseen_yield(Falling(), waves, rows)
    assert unseen == approx(np.array([1.0, 1 / 4, 1 / 16]) * 0.1 * 0.4, rel=1e-12)
    work = np.geomspace(1e-9, 1e-6, 3)
    without, _ = grid_error(NONE[:3], NONE[:3], work, rows, octaves=0.0)
    error, _ = grid_error(NONE[:3], unseen, work, rows, octaves=0.0)
    assert error == approx(np.hypot(without, unseen), rel=1e-12)


def test_waves_matter_less_where_the_pressure_is_large():
    waves = OmittedWaves(octaves=0.0, slope=0.13, coarser_slope=0.05, removed_slope=0.0, pixel=1e-9)
    area, added = 1e-12, 0.5 * 1e11 * 0.12
    ratios = [waves.pressure_ratio(k * added * area, area, 1e11) for k in (1.0, 3.0, 100.0)]
    assert ratios == approx([0.5**0.5, 3 / 10**0.5, 100 / 10001**0.5], rel=1e-12)
    smallest = approx((0.05 / 0.13) ** 2, rel=1e-12)
    assert waves.pressure_ratio(1e-9 * added * area, area, 1e11) == smallest
    assert waves.pressure_ratio(-1e-6, area, 1e11) == smallest
    assert waves.pressure_ratio(1e-6, 0.0, 1e11) == smallest
    plane = OmittedWaves(octaves=0.0, slope=0.0, coarser_slope=0.0, removed_slope=0.0, pixel=1e-9)
    assert plane.pressure_ratio(1e-6, area, 1e11) == 1.0


def test_each_depth_has_its_own_factor_of_the_yield_pressure(case_text, tmp_path):
    depths = [2e-7, 3e-7, 4e-7]
    companions = Companions(parse_case(case_text), tmp_path, depths)
    alike = {f: companions.weaker(np.full(3, f)) for f in (0.5, 0.8)}
    assert alike[0.5].restitution[2] < 0.99 * alike[0.8].restitution[2]
    mixed = companions.weaker(np.array([0.8, 0.5, 0.8]))
    for k, factor in enumerate((0.8, 0.8, 0.5, 0.8, 0.8)):
        assert mixed.work[k] == approx(alike[factor].work[k], rel=1e-9)
        assert mixed.restitution[k] == approx(alike[factor].restitution[k], rel=1e-9)
    assert companions.weaker(np.ones(3)) is companions.own


def test_a_rough_contact_just_below_its_yield_pressure_has_no_vanishing_error(case_text, tmp_path):
    """On the grid of the case and on larger cells nothing yields, but nodes of a finer grid do."""
    just = re.sub("yield_pressure = .*", 'yield_pressure = "JUST Pa"', case_text)
    just = just.replace('correlation_length = "2 um"', 'correlation_length = "1 um"')
    elastic, _ = run(just.replace("JUST", "1e15"), tmp_path / "elastic")
    contact = parse_case(just.replace("JUST", "1e15")).contact(tmp_path)
    (state,) = loading_path(contact, [elastic[-1]["max_indentation_m"]])
    text = just.replace("JUST", str(1.02 * state.pressure.max()))
    out = ResultsFolder(tmp_path / "just")
    run_realisations(parse_case(text), text, tmp_path, out)
    rows, points = out.rows, out.curve.points
    assert rows[-1]["restitution"] == approx(1.0, rel=1e-9)
    case = parse_case(just.replace("JUST", str(1.02 * state.pressure.max())))
    depths = [each["max_indentation_m"] for each in rows]
    fine = curve_of(case.refined(4).contact(tmp_path), depths, "path")
    missed = 1 - fine.at(np.array([rows[-1]["loading_work_J"]]))[0]
    waves = OmittedWaves.of(case.surface(tmp_path))
    unseen = unseen_yield(Companions(case, tmp_path, depths), waves, points)
    assert 1e-4 < missed < unseen[-1] < rows[-1]["discretisation_error"]


def test_what_no_companion_tells_is_not_known():
    work = np.geomspace(1e-9, 1e-6, 3)
    assert np.isnan(grid_error(np.full(3, math.nan), NONE[:3], work, [one()] * 3, 0.0)[0]).all()
    known, unknown = [0.5, 0.6, 0.7], [math.nan] * 3
    assert np.isnan(scatter(np.array([known, unknown]), work)).all()
    assert np.isnan(scatter(np.array([unknown, known, known]), work)).all()


def test_a_depth_that_fails_leaves_the_others_a_total_error(case_text, tmp_path, monkeypatch):
    real, calls = depths_module.solve, []

    def solve(*arguments, **options):
        calls.append(arguments)
        if len(calls) == 2:
            raise NotConvergedError("the second depth")
        return real(*arguments, **options)

    monkeypatch.setattr(depths_module, "solve", solve)
    out = ResultsFolder(tmp_path / "out")
    with pytest.raises(NotConvergedError, match="the second depth"):
        run_realisations(parse_case(case_text), case_text, tmp_path, out)
    depths = parse_case(case_text).depths()
    assert [each["max_indentation_m"] for each in out.rows] == [depths[0], *depths[2:]]
    assert all(each["total_error"] > 0 for each in out.rows)
    summary = json.loads((out.path / "summary.json").read_text())
    assert (summary["status"], summary["reason"]) == ("failed", "the second depth")


def test_the_surface_error_is_the_difference_from_the_mean_and_the_interval_of_the_mean():
    work = np.geomspace(1e-9, 1e-6, 3)
    rng = np.random.default_rng(1)
    curves = 0.5 + 0.05 * rng.standard_normal((4000, 3))
    curves[0] = (0.6, 0.5, 0.3)
    half = 1.96 * 0.05 / math.sqrt(4000)
    assert scatter(curves, work) == approx(np.array([0.1, 0.0, 0.2]) + half, abs=2e-3)
    assert np.all(scatter(curves, work) > np.abs(curves[0] - curves.mean(axis=0)) + 0.9 * half)


@pytest.mark.parametrize("surfaces", [3, 8])
def test_the_surface_error_covers_the_mean_of_all_surfaces(surfaces):
    rng, work = np.random.default_rng(2), np.array([1e-9])
    curves = 0.5 + 0.05 * rng.standard_normal((2000, surfaces, 1))
    held = [abs(each[0, 0] - 0.5) <= scatter(each, work)[0] for each in curves]
    assert 0.95 < np.mean(held) < 0.995


def test_resolved_contacts_keep_a_small_error_of_the_grid():
    """The floor is 10 % of the error of 90 % of contacts with such patches: 0.05 at 30 nodes."""
    error, _ = widened_error(0.0, 0.0, 0.0, one(median_patch_nodes=30.0), 0.0)
    assert error == approx(0.1 * 0.05, rel=1e-9)


def test_the_changes_by_materials_add_as_squares(case_text, tmp_path, monkeypatch):
    changes = (0.003, 0.004)
    monkeypatch.setattr(
        Companions, "materials", lambda self, work: [np.full(work.size, c) for c in changes]
    )
    begin, end = case_text.index("[first]"), case_text.index("[roughness]")
    steel = 'first = { material = "steel", radius = "500 um" }\n'
    rows, _ = run(case_text[:begin] + steel + case_text[end:], tmp_path / "out")
    assert [each["material_error"] for each in rows] == approx([0.005] * len(rows), rel=1e-12)


def test_grids_that_agree_without_resolving_have_an_error():
    """Both grids give COR = 1.0000, but cells 16 times finer give 0.979."""
    error, _ = widened_error(0.0, 0.0, 0.0, one(median_patch_nodes=1, restitution=1.0), 0.0)
    assert error > 0.4


def test_converge_states_no_zero_error(case_text, tmp_path):
    text = case_text.replace('"20 nm"', '"0.5 nm"').replace('"300 nm"', '"40 nm"')
    out = ResultsFolder(tmp_path / "out")
    summary = run_convergence(parse_case(text), text, tmp_path, out, 2)
    assert summary["diagnostics"]["largest_total_error"] > 0
    for each in out.rows:
        if not math.isnan(each["total_error"]):
            assert each["total_error"] > (1e-4 if each["resolved"] else 0.02)


TWIN = """
first = {{ material = "glass", radius = "500 um" }}
second = {{ material = "steel", radius = "flat", yield_strength = "2030 MPa" }}
[roughness]
kind = "measured"
file = "{file}"
detrend = "tilt"
extend = "twin"
seed = 1
below_grid = "omit"
[grid]
nodes = [96, 96]
spacing = "0.25 um"
[impact]
velocity = ["0.003 m/s", "0.03 m/s"]
"""


@pytest.fixture(params=["di-3.di", "own.npz"])
def scan(request):
    """Scans of 10 x 10 um on 256 x 256 pixels: one of an AFM, if available, and a generated one."""
    if request.param == "own.npz":
        return request.getfixturevalue("own_scan")
    return request.getfixturevalue("topographies") / request.param


def test_the_error_holds_what_the_grid_took_from_a_twin(scan, tmp_path):
    """Cells of 0.25 um give COR = 0.9418 as if resolved; cells eight times finer give 0.84."""
    text = TWIN.format(file=scan.as_posix())
    rows, summary = run(text, tmp_path / "out")
    case = parse_case(text)
    assert OmittedWaves.of(case.surface(tmp_path)).octaves > 1
    finer = parse_case("total_error = false\n" + text).refined(8)
    fine = ResultsFolder(tmp_path / "fine")
    run_realisations(finer, text, tmp_path, fine)
    for coarse, reference in zip(rows, fine.rows, strict=True):
        assert abs(coarse["restitution"] - reference["restitution"]) < coarse["total_error"]
        assert not coarse["resolved"]
    (warning,) = [each for each in summary["warnings"] if "leaves out waves" in each]
    assert "615 x 615 nodes" in warning
    assert "cells of 0.0391 um" in warning
    assert "set grid.refine = 8," in warning


def test_a_scan_has_places(scan, tmp_path):
    text = TWIN.replace('extend = "twin"\nseed = 1\n', "").replace("[96, 96]", "[40, 40]")
    case = parse_case(text.format(file=scan.as_posix()))
    surfaces = [case.variant(number).surface(tmp_path) for number in range(4)]
    assert surfaces[0].height == approx(case.surface(tmp_path).height, rel=1e-12)
    for k, one in enumerate(surfaces):
        for other in surfaces[:k]:
            assert abs(np.corrcoef(one.height.ravel(), other.height.ravel())[0, 1]) < 0.6


def test_another_body_may_be_the_softer_one_at_an_end_of_the_spread(tmp_path):
    """At the low ends of the spread glass is softer than steel and yields at its hardness."""
    text = (
        'first = { material = "steel", radius = "500 um", yield_strength = "2030 MPa" }\n'
        'second = "glass"\n[interface]\nplasticity = "expanding-cavity"\n'
        '[grid]\nnodes = 64\nspacing = "3 um"\n'
        '[indentation]\nvalues = ["8 um"]\n'
    )
    rows, _ = run(text, tmp_path / "out")
    assert rows[0]["material_error"] > 0
    assert rows[0]["total_error"] >= rows[0]["material_error"] - 1e-12
