"""Previews on the page of `restitution app`: that they say what they are, and are replaced."""

import json
import re

import pytest

from app_page import COMPUTED, RMS, computed, expect, rest, table

PREVIEW = re.compile(r"^preview: 3 of 6 depths, cells of 250 nm")
ADHESION = "#field-interface-work_of_adhesion"


@pytest.fixture(scope="module")
def answer():
    """The lines of the adhesive curve, which the server computes once."""
    return []


@pytest.fixture
def adhesive(page, answer):
    """Begin the adhesive curve of which the page receives only the lines that `kept` returns."""

    def pass_on(route, kept):
        if not answer:
            text = route.fetch(timeout=0).text()
            answer.extend(json.loads(line) for line in text.splitlines())
        route.fulfill(body="".join(json.dumps(line) + "\n" for line in kept(answer)))

    def begun(kept):
        computed(page)
        page.route("**/api/curve", lambda route: pass_on(route, kept))
        page.locator(ADHESION).fill("0.05 J/m^2")
        return page

    return begun


def previews(lines):
    return [line for line in lines if line.get("preview") and not line["progress"]][:1]


def legend(page):
    return page.locator("#cor .legendtext")


def test_a_preview_says_what_it_is(adhesive):
    page = adhesive(previews)
    expect(page.locator("#status")).to_have_text(PREVIEW)
    expect(legend(page).filter(has_text=PREVIEW)).to_have_count(1)
    expect(legend(page).filter(has_text="this contact")).to_have_count(0)
    expect(page.locator("#cursor-text")).to_contain_text(re.compile(r" ± .* preview"))
    expect(legend(page).filter(has_text="usual error of such a preview")).to_have_count(1)
    expect(page.locator("#cor")).to_have_attribute("aria-label", re.compile("^Preview of the"))
    assert len(table(page, "numbers")) == 3


def test_the_preview_remains_below_a_curve_that_is_not_complete(adhesive):
    def begin_of_the_curve(lines):
        last = lines[-1] | {"progress": "2 of 6 depths"}
        del last["seconds"]
        return [*previews(lines), last]

    page = adhesive(begin_of_the_curve)
    expect(page.locator("#status")).to_have_text(
        re.compile("^2 of 6 depths; the rest is a preview: 3")
    )
    expect(legend(page).filter(has_text=PREVIEW)).to_have_count(1)
    expect(legend(page).filter(has_text="this contact")).to_have_count(1)
    expect(page.locator("#cursor-text")).not_to_contain_text("preview")


def test_the_answer_beyond_a_growing_curve_is_that_of_the_preview(adhesive, answer):
    def begin_of_the_curve(lines):
        last = lines[-1] | {"progress": "2 of 6 depths"}
        del last["seconds"]
        half = len(last["between"]["velocity"]) // 2
        last["between"] = {name: values[:half] for name, values in last["between"].items()}
        return [*previews(lines), last]

    page = adhesive(begin_of_the_curve)
    expect(page.locator("#status")).to_have_text(re.compile("^2 of 6 depths; the rest is a"))
    slow, fast = (line["between"]["velocity"] for line in (answer[-1], previews(answer)[0]))
    for velocity, detail in ((slow[1], "not complete yet"), (fast[-2], "A preview with the error")):
        page.locator("#answer-velocity").fill(f"{velocity} m/s")
        expect(page.locator("#answer-value")).to_have_text(re.compile(r"^e ≈ 0|^e ≈ 1"))
        expect(page.locator("#answer-detail")).to_contain_text(detail)


def test_the_curve_of_the_case_replaces_its_preview(page):
    computed(page)
    page.locator(ADHESION).fill("0.05 J/m^2")
    expect(page.locator("#status")).not_to_have_text(COMPUTED)
    computed(page)
    assert len(table(page, "numbers")) == 6
    expect(legend(page).filter(has_text="preview")).to_have_count(0)
    expect(page.locator("#cursor-text")).not_to_contain_text("preview")


def test_a_pin_of_a_preview_says_so(adhesive):
    page = adhesive(previews)
    expect(page.locator("#status")).to_have_text(PREVIEW)
    page.get_by_role("button", name="Pin this curve").click()
    assert "the first pin; preview: 3 of 6 depths" in table(page, "pins")[0][1]


def test_a_change_replaces_a_preview_and_its_refinement(adhesive):
    page = adhesive(previews)
    expect(page.locator("#status")).to_have_text(PREVIEW)
    page.unroute("**/api/curve")
    page.locator(ADHESION).fill("")
    page.locator(RMS).fill("21 nm")
    computed(page)
    expect(legend(page).filter(has_text="preview")).to_have_count(0)


def test_the_page_says_how_long_it_has_been_computing(adhesive):
    page = adhesive(previews)
    expect(page.locator("#status")).to_have_text(PREVIEW)
    expect(page.locator("#elapsed")).to_have_text(re.compile(r"^\d+ s$"))
    page.unroute("**/api/curve")
    page.locator(ADHESION).fill("")
    rest(page)
    expect(page.locator("#elapsed")).to_be_empty()
