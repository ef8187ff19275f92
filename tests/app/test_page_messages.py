"""Messages of the page: its own words, beside the field, with a button for the remedy."""

import re

import numpy as np
import pytest

from app_page import change, computed, expect, rest, table


def drop(page, file):
    page.locator("#scan").set_input_files(file)


@pytest.fixture
def wavy(tmp_path):
    """Heights of a rough scan (m), 48 x 40 pixels."""
    return 20e-9 * np.random.default_rng(1).standard_normal((48, 40))


def test_an_unresolved_contact_offers_to_refine(page):
    computed(page)
    page.locator("#field-grid-spacing").fill("1 um")
    expect(page.locator("#resolved")).to_have_text(re.compile("^not resolved at"))
    warning = page.locator(".warning", has_text="not resolved").first
    expect(warning).not_to_contain_text("grid.refine")
    page.locator("#answer").get_by_role("button", name="Refine where needed").click()
    expect(page.locator("#field-grid-refine")).to_have_value("auto")
    expect(page.locator("#resolved")).to_have_text("resolved ✓")


def test_a_grid_that_is_too_small_offers_a_larger_one(page):
    computed(page)
    page.locator("#field-indentation-to").fill("1 um")
    expect(page.locator("#general")).to_contain_text("reaches the edge")
    page.get_by_role("button", name="Use a larger grid").first.click()
    expect(page.locator("#field-grid-nodes")).not_to_have_value("64")
    expect(page.locator("#general")).to_be_hidden()


def test_missing_pixels_are_told_in_the_words_of_the_page(page, wavy, tmp_path):
    wavy[3, 4] = np.nan
    np.save(tmp_path / "nan.npy", wavy)
    rest(page)
    drop(page, tmp_path / "nan.npy")
    page.locator("#field-roughness-size").fill("12 um, 10 um")
    problem = page.locator("#form .problem:visible", has_text="pixels").first
    expect(problem).to_contain_text("nan.npy")
    expect(problem).not_to_contain_text("/")
    page.get_by_role("button", name="Set Missing pixels to interpolate").first.click()
    expect(page.locator("#field-roughness-undefined")).to_have_value("interpolate")
    expect(problem).to_be_hidden()


def test_the_pixels_of_a_scan_without_a_size_become_the_grid(page, wavy, tmp_path):
    np.save(tmp_path / "bare.npy", wavy)
    rest(page)
    drop(page, tmp_path / "bare.npy")
    expect(page.locator("#field-roughness-size-problem")).to_contain_text("edge lengths")
    page.locator("#field-roughness-size").fill("12 um, 10 um")
    expect(page.locator("#grid-verdict")).to_have_text("the pixels of the scan")
    expect(page.locator("#statistics")).to_contain_text("48 × 40")
    texts = dict(table(page, "statistics"))
    assert texts["nodes"] == "48 × 40"
    assert texts["spacing"] == "250 nm × 250 nm"


def test_a_scan_that_is_dropped_twice_keeps_its_name(page, wavy, tmp_path):
    np.save(tmp_path / "twice.npy", wavy)
    rest(page)
    for _ in range(2):
        drop(page, tmp_path / "twice.npy")
        expect(page.locator("#field-roughness-file")).to_have_value("twice.npy")
        expect(page.locator("#field-roughness-size-problem")).to_contain_text("edge lengths")


def test_the_lines_of_a_dem_code_are_shown_without_comments(page):
    computed(page)
    page.get_by_label("DEM code").select_option("lammps")
    page.get_by_role("button", name="Show the lines").click()
    lines = page.locator("#code-lines")
    expect(lines).to_contain_text("pair_coeff")
    assert not re.search("^#", lines.inner_text(), re.MULTILINE)


def test_the_time_left_is_told(page):
    """From the share of a run that is done."""
    rest(page)
    page.evaluate(
        """async () => {
          const { say } = await import("./live.js"), busy = { since: performance.now() - 10_000 };
          say("surface 1 of 7", busy, 0.2);
          await new Promise((done) => setTimeout(done, 500));
          say("surface 2 of 7", busy, 0.3);
        }"""
    )
    expect(page.locator("#elapsed")).to_have_text(re.compile(r"^\d+ s, about \d s left$"))
    change(page, "#field-roughness-rms", "25 nm")
