"""Figures, page and terminal of many impacts, from made-up results."""

import dataclasses

import numpy as np
import pytest

from restitution.cli.run import _run_in, _steady
from restitution.pages.run_in import run_in_parts
from restitution.plots.figure import Band, Points, legend_entries
from restitution.plots.run_in import coverage_curves, impacts_figure, run_in_figure
from restitution.plots.static import write_figure
from restitution.repeated.points import RepeatedImpact, RunInPoint, SteadyState
from tolerance import approx

SPEEDS = 0.05, 0.2


def impact(number, velocity, restitution):
    base = dict.fromkeys(RepeatedImpact.__dataclass_fields__, 1.0)
    given = {"number": number, "coverage": 0.05 * number, "velocity": velocity}
    return RepeatedImpact(**base | given | {"restitution": restitution})


@pytest.fixture
def sequences():
    noise = np.random.default_rng(2).normal(0, 0.02, 60)
    return [[impact(k, V, 0.5 + 0.004 * k + noise[k]) for k in range(1, 60)] for V in SPEEDS]


@pytest.fixture
def points(sequences):
    after = {
        coverage: [
            dataclasses.replace(
                RunInPoint.of(hits[-5:] if coverage else hits[:5]), coverage=coverage, velocity=V
            )
            for V, hits in zip(SPEEDS, sequences, strict=True)
        ]
        for coverage in (0.0, 3.0)
    }
    return [after[coverage][k] for k in range(2) for coverage in (0.0, 3.0)]


def summary(sequences):
    state = dataclasses.asdict(SteadyState.of(sequences[0]))
    surface = {"file": "run-in-1-first.npz", "Sq_m": 1e-7, "Sz_m": 5e-7, "Ssk": -0.5}
    entry = {
        "sequence": 1,
        "impacts": 59,
        "coverage": 2.95,
        "steady_state": state,
        "surfaces": {"first": surface | {"Sku": 3.0, "Sdq": 0.1}},
    }
    return {"sequences": [entry, {**entry, "sequence": 2, "steady_state": None}]}


def test_points_of_one_coverage_make_a_curve(points):
    new, worn = coverage_curves(points)
    assert (new.coverage, worn.coverage) == (0, 3)
    assert [point.velocity for point in worn.points] == list(SPEEDS)


def test_a_figure_has_a_curve_and_a_band_for_each_coverage(points, tmp_path):
    figure = run_in_figure(points, "worn")
    (chart,) = figure.panels
    kinds = [type(part) for part in chart.series]
    assert kinds == [Band, Points] * 2
    assert {"new surfaces", "coverage 3"} <= set(legend_entries(chart))
    assert chart.series[1].y == approx([points[0].restitution, points[2].restitution])
    assert write_figure(tmp_path / "figure", figure).stat().st_size > 1000


def test_a_figure_shows_every_impact_and_a_moving_mean(sequences):
    (chart,) = impacts_figure(sequences).panels
    each, mean = chart.series[:2]
    assert each.y == approx([hit.restitution for hit in sequences[0]])
    assert np.std(np.diff(mean.y)) <= np.std(np.diff(each.y))
    assert mean.label == "at 50 mm/s"


def test_the_page_has_the_tables_of_points_sequences_and_surfaces(points, sequences):
    curve, course, surfaces = run_in_parts(points, sequences, summary(sequences))
    assert len(curve.table.rows) == 4
    assert course.table.rows[0][-1].startswith("no (+")
    assert course.table.rows[1][-1] == "too few impacts"
    assert surfaces.rows[0][2:5] == ["run-in-1-first.npz", "100 nm", "500 nm"]


def test_the_terminal_shows_the_table_and_says_whether_restitution_is_steady(points, sequences):
    table = _run_in(points)
    assert table.row_count == 4
    said = list(_steady({"run_in": summary(sequences)}))
    assert said[0].startswith(
        "COR may still change after 59 impacts (coverage 2.95) at 0.05 m/s: by +"
    )
    assert len(said) == 1
    assert list(_steady({})) == []
