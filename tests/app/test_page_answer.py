"""The answer at the top of the page, presets, the chosen grid and what a new material clears."""

import re

import numpy as np
import pytest

from app_page import RMS, change, computed, expect, rest, shown
from restitution.app.grid import with_grid
from restitution.app.headline import headline
from restitution.app.presets import presets
from restitution.case.case_file import parse_case, parse_toml
from restitution.curve.follow import follow
from restitution.runs.depths import CaseUnloading, loads_of
from tolerance import approx

VELOCITIES = """
title = "A small rough contact"
[first]
material = "steel"
radius = "100 um"
[interface]
yield_strength = "300 MPa"
[roughness]
kind = "gaussian"
rms = "20 nm"
correlation_length = "1 um"
seed = 1
[impact]
from = "20 mm/s"
to = "1 m/s"
steps = 5
"""
ANSWER = "#answer-value"
E = re.compile(r"^e = 0\.\d+ ± 0\.\d+$")


def use(page, text):
    """Make `text` the case of the page."""
    details = page.locator("#case-file")
    if details.get_attribute("open") is None:
        details.locator("summary").click()
    page.locator("#case-text").fill(text)
    page.get_by_role("button", name="Use this text").click()


@pytest.fixture
def small(page):
    """The page with a small case of impact velocities, and its errors."""
    use(page, VELOCITIES)
    expect(page.locator("#field-impact-steps")).to_have_value("5")
    rest(page)
    return page


def test_the_answer_is_that_of_the_curve_at_the_velocity(small):
    expect(small.locator(ANSWER)).to_have_text(E)
    rows = shown(small)
    for velocity, restitution in zip(
        rows["impact_velocity_m_per_s"], rows["restitution"], strict=True
    ):
        small.locator("#answer-velocity").fill(f"{velocity!r} m/s")
        e = float(small.locator(ANSWER).inner_text().split()[2])
        assert e == approx(restitution, abs=0.006)
    small.locator("#answer-velocity").fill("0.1")
    expect(small.locator("#answer-detail")).to_contain_text("with its unit")
    assert small.locator("#answer-velocity").get_attribute("aria-invalid") == "true"


def test_a_velocity_outside_the_range_can_be_computed_too(small):
    small.locator("#answer-velocity").fill("2 m/s")
    expect(small.locator(ANSWER)).to_have_text("e = –")
    expect(small.locator("#answer-detail")).to_contain_text("20 mm/s to 1 m/s")
    small.get_by_role("button", name="Compute this velocity too").click()
    expect(small.locator("#field-impact-to")).to_have_value("2 m/s")
    expect(small.locator(ANSWER)).to_have_text(re.compile(r"^e . 0\.\d+"))


def test_the_errors_of_solver_and_grid_come_before_the_scatter(app, open_page):
    page = open_page(app.address, lambda page: page.route("**/api/run", lambda route: None))
    expect(page.locator("#answer-detail")).to_contain_text("that of solver, grid and materials")
    assert all(error > 0 for error in shown(page)["total_error"])


def test_run_in_is_computed_at_the_velocity_of_the_answer(small):
    small.locator("#answer-velocity").fill("0.3 m/s")
    small.get_by_role("button", name="Compute run-in").click()
    expect(small.locator("#answer-facts")).to_contain_text(
        re.compile(r"After run-ine = 0\.\d+.* impacts\); new: 0\.\d+")
    )


def test_a_new_material_clears_what_was_typed_for_the_old_one(page):
    computed(page)
    page.locator("#field-first-material").select_option("polystyrene")
    expect(page.locator("#field-interface-yield_strength")).to_have_value("")
    expect(page.locator("#cleared")).to_contain_text("300 MPa")
    page.get_by_role("button", name="Put back").click()
    expect(page.locator("#field-interface-yield_strength")).to_have_value("300 MPa")


def test_a_switch_sets_adhesion_and_leaves_it_out(page):
    computed(page)
    page.route("**/api/curve", lambda route: None)
    switch, field = (
        page.locator("#field-interface-work_of_adhesion-switch"),
        page.locator("#field-interface-work_of_adhesion"),
    )
    expect(switch).not_to_be_checked()
    expect(page.locator("#field-interface-work_of_adhesion-slider")).to_be_hidden()
    switch.check()
    expect(field).to_have_value("0.05 J/m^2")
    expect(page.locator("#field-interface-work_of_adhesion-slider")).to_be_visible()
    switch.uncheck()
    expect(field).to_have_value("")


def test_help_says_what_a_symbol_is(page):
    computed(page)
    assert page.locator("#field-roughness-rms-help").is_hidden()
    page.get_by_role("button", name="What is Rq?").click()
    expect(page.locator("#field-roughness-rms-help")).to_have_text("Rq, met exactly")
    for button in page.get_by_role("button", name=re.compile("^What is ")).all():
        helped = page.locator(f"#{button.get_attribute('aria-controls')}")
        assert helped.text_content().strip()


def test_the_help_page_is_served(app, open_page):
    page = open_page(app.address.replace("/#", "/help#"))
    expect(page.get_by_role("heading", name="Symbols")).to_be_visible()
    expect(page.locator("body")).to_contain_text("sticking velocity")


def test_a_preset_fills_the_form(page):
    computed(page)
    page.locator("#preset").select_option(label="Polymer granule")
    expect(page.locator("#field-first-material")).to_have_value("hdpe")
    expect(page.locator("#field-first-radius")).to_have_value("1 mm")
    expect(page.locator("#grid-verdict")).to_contain_text(re.compile(r"^\d+ nodes of .*m$"))
    expect(page.locator("#field-grid-nodes")).to_have_count(0)


@pytest.mark.parametrize("preset", presets(), ids=lambda preset: preset["title"])
def test_the_chosen_grid_contains_each_preset_and_resolves_its_waves(preset, tmp_path):
    from restitution.app.content import text_of

    text, grid = with_grid(text_of(preset["content"]), tmp_path)
    assert set(grid) <= {"nodes", "spacing", "refine"}
    case = parse_case(text)
    contact = (
        case.refined(1).contact(tmp_path) if case.grid.refine == "auto" else case.contact(tmp_path)
    )
    (part,) = case.roughness
    assert max(contact.grid.spacing) <= min(part.correlation_length) / 6
    assert grid["nodes"] <= 512
    if not case.interface.adhesive_energy:
        deepest = [
            *follow(loads_of(case, tmp_path, contact, unloaded=0), CaseUnloading.of_case(case))
        ]
        assert len(deepest) == len(case.depths())


def test_a_case_keeps_its_own_grid(tmp_path):
    text = VELOCITIES + '[grid]\nnodes = 64\nspacing = "0.25 um"\n'
    assert with_grid(text, tmp_path) == (text, None)
    refined, grid = with_grid(VELOCITIES + "[grid]\nrefine = 2\n", tmp_path)
    assert grid["refine"] == 2
    assert parse_toml(refined)["grid"] == grid


def test_a_case_with_a_wrong_key_gets_no_grid(tmp_path):
    _, grid = with_grid(VELOCITIES.replace("100 um", "-100 um"), tmp_path)
    assert grid is None


def test_the_headline_has_the_points_and_the_jump(tmp_path):
    text = """
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
[impact]
velocity = ["10 mm/s", "20 mm/s", "40 mm/s", "80 mm/s"]
"""
    case = parse_case(text)
    contact = case.contact(tmp_path)
    loads = loads_of(case, tmp_path, contact, unloaded=0)
    points = [impact.point for impact in follow(loads, CaseUnloading.of_case(case))]
    assert [point.sticks for point in points] == [True, True, False, False]
    between = headline(points)["between"]
    V, e = np.array(between["velocity"]), np.array(between["restitution"])
    assert (np.diff(V) > 0).all()
    for point in points:
        assert np.interp(point.impact_velocity, V, e) == approx(point.restitution, abs=1e-6)
    # The curve leaves zero as sqrt(1 - (V_s/V)^2), not as a straight line between two points.
    first = int(np.flatnonzero(e > 0)[0])
    assert V[first] / V[first - 1] < 1.02
    middle = float(np.interp(0.5 * (V[first] + 0.04), V, e))
    assert middle > 0.6 * points[2].restitution


def test_a_curve_without_velocities_has_no_headline():
    assert headline([]) == {}


def test_a_changed_value_dims_the_old_curve_at_once(page):
    computed(page)
    page.route("**/api/curve", lambda route: None)  # never answered
    page.locator(f"{RMS}-slider").fill("500")
    for part in ("cor", "answer", "force"):
        expect(page.locator(f"#{part}")).to_have_class(re.compile(r"\bstale\b"), timeout=1000)


def test_stop_ends_what_is_computed(page):
    computed(page)
    page.route("**/api/curve", lambda route: None)
    page.locator(RMS).fill("22 nm")
    page.get_by_role("button", name="Stop").click()
    expect(page.locator("#status")).to_have_text(re.compile("^stopped"))
    expect(page.get_by_role("button", name="Stop")).to_be_hidden()
    page.unroute("**/api/curve")
    change(page, RMS, "23 nm")
