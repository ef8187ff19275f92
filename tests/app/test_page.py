"""The page of `restitution app` in a browser: what it draws, and what a reader changes."""

import json
import re

import pytest

from app_page import (
    COMPLETE,
    NUMBERS,
    RMS,
    change,
    computed,
    drawn_curve,
    expect,
    rest,
    run,
    shown,
    table,
    taken,
)
from tolerance import approx


def test_the_first_page_is_drawn_whole(new_page):
    rest(new_page)
    for plot in ("cor", "force", "pressure", "plastic", "surface"):
        assert new_page.locator(f"#{plot} svg").count() > 0, plot
    assert len(table(new_page, "numbers")) == 6
    assert [row[0] for row in table(new_page, "statistics")][:2] == ["nodes", "spacing"]
    assert "rms curvature" in [row[0] for row in table(new_page, "statistics")]
    expect(new_page.locator("#general")).to_be_hidden()
    label = new_page.locator("#cor").get_attribute("aria-label")
    assert re.match(r"Coefficient of restitution from 0\.\d+ to 0\.\d+ against impact", label)


def test_no_button_of_a_plot_sends_it_elsewhere(page):
    computed(page)
    titles = page.locator("#cor .modebar-btn")
    expect(titles.first).to_be_attached()
    names = [title.get_attribute("data-title") for title in titles.all()]
    assert "Download plot as a PNG" in names
    assert [title for title in names if "hare" in title or "loud" in title] == []


def test_the_curve_is_drawn_against_indentation_too(page):
    computed(page)
    before = page.locator("#cor .xtitle").text_content()
    page.get_by_role("radio", name="against indentation").check()
    expect(page.locator("#cor .xtitle")).not_to_have_text(before)
    assert "indentation" in page.locator("#cor .xtitle").text_content().lower()


def test_a_slider_changes_its_field_and_the_curve(page):
    computed(page)
    before = drawn_curve(page)
    page.locator(f"{RMS}-slider").fill("700")
    expect(page.locator(RMS)).to_have_value("631 nm")
    expect(page.locator("#cor .scatterlayer path.js-line").first).not_to_have_attribute("d", before)


def test_an_arrow_key_moves_a_slider(page):
    computed(page)
    page.locator(f"{RMS}-slider").focus()
    page.keyboard.press("ArrowRight")
    expect(page.locator(RMS)).not_to_have_value("20 nm")
    rms = page.locator(RMS).input_value()
    expect(page.locator(f"{RMS}-slider")).to_have_attribute("aria-valuetext", rms)


def test_many_quick_changes_end_with_the_curve_of_the_newest_values(page, live_case, tmp_path):
    rest(page)
    for position in range(200, 420, 11):
        page.locator(f"{RMS}-slider").fill(str(position))
    page.locator("#field-first-radius-slider").fill("520")
    rms, radius = (
        page.locator(f"#field-{key}").input_value() for key in ("roughness-rms", "first-radius")
    )
    assert (rms, radius) != ("20 nm", "100 um")
    rest(page)
    text = live_case.replace('20 nm"\ncorr', f'{rms}"\ncorr').replace("100 um", radius)
    expected = run(text, tmp_path)
    for name, values in shown(page).items():
        rel = 0.06 if name == "total_error" else 1e-5  # two digits of errors are shown
        assert values == approx([row[name] for row in expected], rel=rel), name


def test_the_exported_case_gives_the_numbers_of_the_page_to_the_last_digit(
    app, open_page, tmp_path
):
    answers = []

    def listen(page):
        def pass_on(route):
            answer = route.fetch(timeout=0)
            answers.append(answer.text())
            route.fulfill(response=answer)

        page.route("**/api/run", pass_on)

    page = open_page(app.address, listen)
    rest(page)
    (results,) = [json.loads(line) for line in answers[-1].splitlines() if "results" in line]
    case = taken(page, "Case file", tmp_path)
    assert case.name == "case.toml"
    expected = run(case.read_text(), tmp_path)
    assert len(expected) == 6
    assert [{name: row[name] for name in NUMBERS} for row in results["results"]] == expected


def test_pinned_curves_are_drawn_compared_and_removed(page):
    computed(page)
    drawn = page.locator("#cor .legendtext", has_text=re.compile("^pin "))
    page.get_by_role("button", name="Pin this curve").click()
    change(page, RMS, "40 nm")
    page.get_by_role("button", name="Pin this curve").click()
    assert [row[1] for row in table(page, "pins")] == ["the first pin", "roughness.rms = 40 nm"]
    expect(drawn).to_have_text(["pin 1", "pin 2"])
    page.get_by_role("button", name="Remove pin 2").click()
    expect(drawn).to_have_text(["pin 1"])
    page.get_by_role("button", name="Restore its values").click()
    expect(page.locator(RMS)).to_have_value("20 nm")
    page.get_by_role("button", name="Remove pin 1").click()
    expect(page.locator("#no-pins")).to_be_visible()


def test_the_axes_include_a_pinned_curve(page):
    computed(page)
    page.get_by_role("button", name="Pin this curve").click()
    change(page, "#field-indentation-to", "30 nm")
    low, high = page.evaluate("document.getElementById('cor').layout.xaxis.range")
    (pinned,) = page.evaluate(
        "document.getElementById('cor').data.filter((t) => t.name === 'pin 1').map((t) => t.x)"
    )
    assert 10**low < min(pinned) < max(pinned) < 10**high
    low, high = page.evaluate("document.getElementById('force').layout.xaxis.range")
    assert low <= 0.02 < 0.2 < high  # in µm


def test_the_cursor_is_moved_by_arrow_keys(page):
    computed(page)
    page.locator("#cursor").focus()
    expect(page.locator("#maps-text")).to_contain_text("At an indentation of 200 nm")
    text, maps = (page.locator(part).inner_text() for part in ("#cursor-text", "#maps-text"))
    page.keyboard.press("ArrowLeft")
    expect(page.locator("#cursor-text")).not_to_have_text(text)
    expect(page.locator("#maps-text")).not_to_have_text(maps)
    page.keyboard.press("Home")
    expect(page.locator("#maps-text")).to_contain_text("At an indentation of 20 nm")
    expect(page.locator("#cursor-text")).to_contain_text(" 20 nm")


@pytest.mark.parametrize("width", [1400, 820, 390])
def test_nothing_is_wider_than_the_window(app, open_page, width):
    page = open_page(app.address, viewport={"width": width, "height": 900}, color_scheme="light")
    rest(page)
    for colours in ("light", "dark"):
        if colours == "dark":
            page.emulate_media(color_scheme="dark")
            expect(page.locator("#status")).not_to_have_text(COMPLETE)  # it is drawn again
            rest(page)
        assert page.evaluate("() => document.documentElement.scrollWidth") <= width
        paper = page.evaluate("() => getComputedStyle(document.body).backgroundColor")
        assert (paper == "rgb(255, 255, 255)") == (colours == "light")


def test_every_input_has_a_name(new_page):
    computed(new_page)
    for section in new_page.locator("details").all():
        section.evaluate("(details) => { details.open = true; }")
    controls = new_page.locator("input, select, textarea, button").filter(visible=True).all()
    assert len(controls) > 40
    for control in controls:
        expect(control).to_have_accessible_name(re.compile(r"\S"))


def test_the_keyboard_reaches_the_pin_a_field_and_a_slider(new_page):
    computed(new_page)
    reached = []
    for _ in range(12):
        new_page.keyboard.press("Tab")
        reached.append(new_page.locator(":focus").get_attribute("id"))
    wanted = ["pin", "field-first-material", "field-first-radius", "field-first-radius-slider"]
    assert [name for name in reached if name in wanted] == wanted
