"""Wrong input on the page of `restitution app`, and the case as a text."""

import re

import pytest

from app_page import RMS, change, computed, expect, refusal, rest, table


def test_a_length_without_a_unit_is_told_beside_its_field(page, live_case):
    computed(page)
    page.locator("#field-first-radius").fill("500")
    problem = page.locator("#field-first-radius-problem")
    expect(problem).to_be_visible()
    whole = refusal(live_case.replace('"100 um"', '"500"'))
    assert f"first.radius: {problem.inner_text()}" == whole
    expect(page.locator("#field-first-radius")).to_have_attribute("aria-invalid", "true")
    change(page, "#field-first-radius", "90 um")
    expect(problem).to_be_hidden()
    assert page.locator("#field-first-radius").get_attribute("aria-invalid") is None


def test_depths_that_reach_the_edge_are_missing_and_the_others_are_drawn(page):
    computed(page)
    page.locator("#field-indentation-to").fill("1 um")
    expect(page.locator("#general")).to_contain_text("the contact reaches the edge of the 16 um")
    assert 0 < len(table(page, "numbers")) < 6
    change(page, "#field-indentation-to", "180 nm")
    expect(page.locator("#general")).to_be_hidden()


def test_a_message_of_the_solver_is_told_and_the_old_curve_is_faint(page):
    """A particle below its roughness is found by the solver, not by the reader of case files."""
    computed(page)
    page.locator(RMS).fill("90 um")
    expect(page.locator("#general")).to_contain_text("is smaller than its roughness")
    expect(page.locator("#cor")).to_have_class(re.compile(r"\bstale\b"))
    change(page, RMS, "20 nm")
    expect(page.locator("#cor")).not_to_have_class(re.compile(r"\bstale\b"))


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("roughness.correlation_length", "1 nm", "is below the grid spacing"),
        ("grid.refine", "3", "2"),
        ("first.radius", "-1 um", "must be greater than zero"),
    ],
)
def test_each_problem_is_shown_on_the_page(page, field, value, words):
    computed(page)
    page.locator(f"#field-{field.replace('.', '-')}").fill(value)
    expect(page.locator("#form .problem:visible").first).to_contain_text(words)
    expect(page.locator("#status")).to_have_text(re.compile("^not computed"))


def test_a_message_about_a_table_is_told_beside_a_field(page):
    computed(page)
    page.locator("#field-indentation-from").fill("1 um")
    expect(page.locator("#field-indentation-from-problem")).to_contain_text("must be smaller")
    for end in ("from", "to", "steps"):
        page.locator(f"#field-indentation-{end}").fill("")
    expect(page.locator("#field-indentation-from-problem")).to_contain_text("give `from`, `to` and")
    expect(page.locator("#field-depths")).to_have_value("indentation")


def test_values_return_with_their_fields_after_a_choice_is_taken_back(page):
    computed(page)
    page.locator("#field-second").select_option("own")
    expect(page.locator("#field-second-material")).to_have_value("steel")
    change(page, "#field-second-radius", "1 mm")
    change(page, RMS, "30 nm")
    for field, away, back in (
        ("second", "", "own"),
        ("roughness-kind", "", "gaussian"),
        ("depths", "load", "indentation"),
    ):
        page.locator(f"#field-{field}").select_option(away)
        page.locator(f"#field-{field}").select_option(back)
    expect(page.locator("#field-second-radius")).to_have_value("1 mm")
    expect(page.locator(RMS)).to_have_value("30 nm")
    expect(page.locator("#field-roughness-correlation_length")).to_have_value("1 um")
    expect(page.locator("#field-indentation-to")).to_have_value("200 nm")
    computed(page)


@pytest.mark.parametrize("value", ["1979-01-01", "inf", "nan"])
def test_a_text_with_a_value_that_no_case_has_is_told(page, live_case, value):
    computed(page)
    page.locator("#case-file summary").click()
    expect(page.locator("#case-text")).to_have_value(re.compile('material = "steel"'))
    page.locator("#case-text").fill(f"colour = {value}\n{live_case}")
    page.get_by_role("button", name="Use this text").click()
    expect(page.locator("#text-problem")).to_contain_text("no key of a case accepts such a value")


def test_an_unknown_key_of_the_case_as_a_text_is_told(page, live_case):
    computed(page)
    page.locator("#case-file summary").click()
    expect(page.locator("#case-text")).to_have_value(re.compile('material = "steel"'))
    text = live_case.replace("[interface]", 'colour = "red"\n[interface]')
    page.locator("#case-text").fill(text)
    page.get_by_role("button", name="Use this text").click()
    expect(page.locator("#general")).to_have_text(refusal(text))


def test_a_text_that_is_no_case_is_told_and_changes_nothing(page):
    computed(page)
    page.locator("#case-file summary").click()
    page.locator("#case-text").fill("radius = = 3")
    page.get_by_role("button", name="Use this text").click()
    expect(page.locator("#text-problem")).to_contain_text("not valid TOML")
    assert page.locator("#field-first-radius").input_value() == "100 um"


def test_a_text_that_arrives_late_does_not_replace_a_selection(page, live_case):
    """Else a text that is pasted over the selection would be added to the late one."""
    rest(page)
    held = []
    page.route("**/api/text", lambda route: held.append(route))
    with page.expect_request("**/api/text"):
        page.locator("#case-file summary").click()
    page.locator("#case-text").press("Control+A")
    while not held:  # the browser reports the request before its route
        page.wait_for_timeout(10)
    with page.expect_response("**/api/text") as answer:
        held[0].continue_()
    answer.value.finished()
    page.keyboard.insert_text(live_case)
    assert page.locator("#case-text").input_value() == live_case


def test_a_case_as_a_text_fills_the_form(page, live_case):
    rest(page)
    page.locator("#case-file summary").click()
    page.locator("#case-text").fill(live_case.replace('"100 um"', '"120 um"'))
    page.get_by_role("button", name="Use this text").click()
    expect(page.locator("#field-first-radius")).to_have_value("120 um")
    computed(page)


def test_a_field_is_hidden_while_another_choice_leaves_it_without_effect(page):
    computed(page)
    page.locator("#groups summary", has_text="More").nth(1).click()
    page.locator("#field-interface-approach").select_option("hertzian")
    page.locator("#field-interface-adhesion").select_option("cohesive")
    expect(page.locator("#field-interface-approach")).to_have_count(0)
    page.locator("#field-interface-adhesion").select_option("")
    expect(page.locator("#field-interface-approach")).to_have_value("hertzian")
