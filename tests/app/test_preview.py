"""Previews of the live curve: what they leave out, how near they come, and when they are drawn."""

import json

import pytest

from restitution.app.curve import LiveCurves
from restitution.app.preview import Ladder, Pace
from restitution.case.case_file import parse_case
from restitution.curve.follow import follow
from restitution.runs.depths import CaseUnloading, loads_of
from tolerance import approx

DRY = """
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.25
density = "7850 kg/m^3"
[interface]
yield_strength = "268 MPa"
[roughness]
kind = "gaussian"
rms = "0.1 um"
correlation_length = "2 um"
seed = 1
[grid]
nodes = 256
spacing = "0.25 um"
[indentation]
from = "2 nm"
to = "1 um"
steps = 24
"""
IMPACT = DRY.split("[indentation]")[0] + '[impact]\nfrom = "1 mm/s"\nto = "0.3 m/s"\nsteps = 9\n'
JKR = """
[first]
radius = "20 um"
youngs_modulus = "3 GPa"
poissons_ratio = 0.3
density = "1000 kg/m^3"
[interface]
yield_pressure = "elastic"
work_of_adhesion = "0.05 J/m^2"
adhesion = "jkr"
[grid]
nodes = 64
spacing = "60 nm"
[indentation]
values = ["60 nm", "80 nm", "100 nm"]
"""
COHESIVE = """
[first]
material = "silica"
radius = "5 um"
[interface]
work_of_adhesion = "0.05 J/m^2"
adhesion = "cohesive"
[grid]
nodes = 64
spacing = "8 nm"
[indentation]
values = ["1 nm", "2 nm", "4 nm"]
"""


def ladder_of(text, folder):
    case = parse_case(text)
    return Ladder(case, case.contact(folder))


def computed(ladder, level):
    return [impact.point for impact in follow(ladder.loads(level), ladder.unloading)]


def whole(ladder, folder):
    case = ladder.case
    loads = loads_of(case, folder, case.contact(folder), unloaded=0)
    return {i.load.prescribed: i.point for i in follow(loads, CaseUnloading.of_case(case))}


def lines(text, folder, curves_of_page):
    return [json.loads(line) for line in curves_of_page.lines("a", text, folder, lambda: None)]


def test_each_level_has_fewer_depths_and_larger_cells_than_the_next(tmp_path):
    ladder = ladder_of(DRY, tmp_path)
    depths = ladder.case.depths()
    assert [len(level.depths) for level in ladder.levels] == [3, 6, 12, 24]
    assert [max(level.factors) for level in ladder.levels] == [8, 4, 2, 1]
    for level in ladder.levels:
        assert {depths[0], depths[-1]} <= set(level.depths) <= set(depths)
        assert min(level.factors) == 1  # the shallowest contact has few nodes
    assert ladder.words(ladder.levels[0]) == "3 of 24 depths, cells of 250 nm to 2 µm"


def test_a_case_of_one_depth_on_few_nodes_has_no_preview(tmp_path):
    text = JKR.replace("nodes = 64", "nodes = 40").replace(', "80 nm", "100 nm"', "")
    assert len(ladder_of(text, tmp_path).levels) == 1


@pytest.mark.parametrize("text", [DRY, IMPACT, JKR, COHESIVE], ids=["dry", "impact", "jkr", "far"])
def test_previews_come_nearer_to_the_curve(tmp_path, text):
    ladder = ladder_of(text, tmp_path)
    points = whole(ladder, tmp_path)
    errors = []
    for level in ladder.levels[:-1]:
        preview = computed(ladder, level)
        assert len(preview) == len(level.depths)
        pairs = list(zip(preview, (points[depth] for depth in level.depths), strict=True))
        errors.append(max(abs(a.restitution - b.restitution) for a, b in pairs))
        assert [a.force for a, _ in pairs] == approx([b.force for _, b in pairs], rel=0.25)
    assert errors[0] < 0.1
    assert errors[-1] < 0.03


def test_the_curve_after_previews_is_that_of_the_case(tmp_path, monkeypatch):
    """Their tolerances are not used for it."""
    monkeypatch.setattr("restitution.app.preview._SOON", 0.0)
    text = JKR.replace(', "80 nm", "100 nm"', "")
    *previews, last = lines(text, tmp_path, LiveCurves())
    assert previews[0]["preview"]
    points = whole(ladder_of(text, tmp_path), tmp_path)
    assert [row["restitution"] for row in last["curve"]] == [
        point.restitution for point in points.values()
    ]


def test_previews_of_a_slow_curve_come_first_and_say_what_they_are(tmp_path, monkeypatch):
    monkeypatch.setattr("restitution.app.preview._SOON", 0.0)
    monkeypatch.setattr("restitution.app.preview._WORTH_WAITING", 0.0)
    ladder = ladder_of(DRY, tmp_path)
    drawn = [line for line in lines(DRY, tmp_path, LiveCurves()) if not line["progress"]]
    words = [ladder.words(level) for level in ladder.levels[:-1]]
    assert [line.get("preview") for line in drawn] == [*words, None]
    assert [len(line["curve"]) for line in drawn] == [3, 6, 12, 24]


def test_a_preview_that_fails_is_left_out(tmp_path, monkeypatch):
    """A contact at the edge of the grid is reported with the curve of the case, and once."""
    monkeypatch.setattr("restitution.app.preview._SOON", 0.0)
    text = DRY.replace('to = "1 um"', 'to = "3 um"')
    *previews, last = lines(text, tmp_path, LiveCurves())
    assert "reaches the edge" in last["failure"]
    drawn = [line for line in previews if line.get("preview")]
    assert drawn
    assert not any(line["failure"] for line in drawn)


@pytest.mark.parametrize("text", [DRY, COHESIVE], ids=["dry", "cohesive"])
def test_a_refined_grid_is_chosen_after_the_previews(tmp_path, monkeypatch, text):
    monkeypatch.setattr("restitution.app.preview._SOON", 0.0)
    for old, new in (
        ("nodes = 256", 'refine = "auto"\nnodes = 64'),
        ('nodes = 64\nspacing = "8 nm"', 'refine = "auto"\nnodes = 32\nspacing = "16 nm"'),
        ("2 nm", "30 nm" if text == DRY else "2 nm"),
        ('spacing = "0.25 um"', 'spacing = "1 um"'),
        ('adhesion = "cohesive"', ""),
    ):
        text = text.replace(old, new)
    answer = lines(text, tmp_path, LiveCurves())
    first = next(line for line in answer if line.get("preview") and not line["progress"])
    assert len(first["curve"]) == 3
    assert max(row["refine"] for row in answer[-1]["curve"]) > 1


class Clock:
    """Levels that take given times, drawn as the pace of a page decides."""

    def __init__(self, folder, times):
        self.pace, self.ladder, self.times = Pace(), ladder_of(DRY, folder), times

    def drawn(self, spent=0.0):
        """The numbers of the levels that are drawn, and the time until the first of them."""
        numbers, first = [], None
        at = self.pace.first(self.ladder, spent)
        while True:
            spent += self.times[at]
            self.pace.note(self.ladder, at, self.times[at])
            if at == len(self.times) - 1:
                return [*numbers, at], first or spent
            following, wanted = self.pace.next(self.ladder, at, spent)
            if wanted:
                numbers, first = [*numbers, at], first or spent
            at = following


def test_a_fast_curve_has_no_preview(tmp_path):
    clock = Clock(tmp_path, [0.004, 0.01, 0.03, 0.1])
    clock.drawn()
    assert clock.drawn() == ([3], 0.1)


def test_the_finest_preview_that_comes_soon_is_drawn(tmp_path):
    clock = Clock(tmp_path, [0.01, 0.03, 0.1, 0.5])
    clock.drawn()
    assert clock.drawn() == ([2, 3], 0.1)


def test_the_time_before_the_first_solve_counts(tmp_path):
    """That of making the surface, for example."""
    clock = Clock(tmp_path, [0.01, 0.03, 0.1, 0.5])
    clock.drawn()
    assert clock.drawn(spent=0.06) == ([1, 2, 3], 0.09)
    assert clock.drawn(spent=1.0) == ([0, 1, 2, 3], 1.01)


def test_a_slow_curve_is_drawn_coarse_first_and_then_finer(tmp_path):
    clock = Clock(tmp_path, [0.5, 2.0, 8.0, 60.0])
    for _ in range(3):
        assert clock.drawn() == ([0, 1, 2, 3], 0.5)


def test_the_pace_follows_a_change_of_speed(tmp_path):
    clock = Clock(tmp_path, [0.01, 0.03, 0.1, 0.5])
    clock.drawn()
    clock.times = [4 * time for time in clock.times]
    clock.drawn()
    assert clock.drawn() == ([1, 2, 3], 0.12)
    clock.times = [time / 4 for time in clock.times]
    clock.drawn()
    assert clock.drawn() == ([2, 3], 0.1)


def test_times_of_other_curves_do_not_count(tmp_path):
    clock = Clock(tmp_path, [0.004, 0.01, 0.03, 0.1])
    clock.drawn()
    clock.ladder = ladder_of(JKR, tmp_path)
    assert clock.pace.first(clock.ladder, 0.0) == 0


@pytest.mark.parametrize("text", [DRY, IMPACT, JKR, COHESIVE], ids=["dry", "impact", "jkr", "far"])
def test_the_error_of_a_preview_covers_its_difference_from_the_curve(tmp_path, monkeypatch, text):
    monkeypatch.setattr("restitution.app.preview._SOON", 0.0)
    monkeypatch.setattr("restitution.app.preview._WORTH_WAITING", 0.0)
    ladder = ladder_of(text, tmp_path)
    *partial, last = lines(text, tmp_path, LiveCurves())
    previews = [line["curve"] for line in partial if line.get("preview") and not line["progress"]]
    exact = dict(zip(ladder.case.depths(), last["curve"], strict=True))
    assert len(previews) == len(ladder.levels) - 1
    for level, rows in zip(ladder.levels, previews, strict=False):
        for depth, row in zip(level.depths, rows, strict=True):
            assert abs(row["restitution"] - exact[depth]["restitution"]) <= row["total_error"] < 1
