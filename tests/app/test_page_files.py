"""Files that a reader brings to the page of `restitution app`, and takes away; finer runs."""

import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

from app_page import (
    COMPLETE,
    GLASS_BEAD,
    RMS,
    change,
    computed,
    expect,
    names_in,
    rest,
    table,
    taken,
)
from restitution import api
from restitution.errors import CaseError
from tolerance import approx


def test_figures_are_taken_in_each_format(page, tmp_path):
    computed(page)
    names = names_in(taken(page, "Figures", tmp_path))
    assert {Path(name).suffix for name in names} >= {".svg", ".png", ".pdf", ".csv"}


def test_results_are_taken(page, tmp_path):
    computed(page)
    with zipfile.ZipFile(taken(page, "Results", tmp_path)) as archive:
        archive.extractall(tmp_path / "opened")
    assert len(api.open_results(tmp_path / "opened").curve.rows) == 6


def test_the_law_is_taken(page, tmp_path):
    computed(page)
    assert any(name.endswith("law.json") for name in names_in(taken(page, "Law", tmp_path)))


def test_the_report_is_taken(page, tmp_path):
    computed(page)
    report = taken(page, "Report page", tmp_path)
    assert report.suffix == ".html"
    assert "A small rough contact" in report.read_text("utf-8")


def exported(page, folder, velocity):
    page.get_by_label("DEM code").select_option("lammps")
    page.get_by_role("textbox", name="Impact velocity").fill(velocity)
    return taken(page, "Export", folder)


def test_the_input_of_a_dem_code_is_taken(page, tmp_path):
    computed(page)
    with zipfile.ZipFile(exported(page, tmp_path, "0.1 m/s")) as archive:
        texts = [archive.read(name).decode() for name in archive.namelist()]
    assert any("pair_coeff" in text for text in texts)


def test_a_velocity_that_was_not_computed_is_told_as_on_the_command_line(page, tmp_path):
    computed(page)
    with zipfile.ZipFile(taken(page, "Results", tmp_path)) as archive:
        archive.extractall(tmp_path / "opened")
    page.get_by_label("DEM code").select_option("lammps")
    page.get_by_role("textbox", name="Impact velocity").fill("100 km/s")
    page.get_by_role("button", name="Export").click()
    with pytest.raises(CaseError) as refused:
        api.export(tmp_path / "opened", to="lammps", out=tmp_path / "dem", velocity="100 km/s")
    expect(page.locator("#take-status")).to_have_text(str(refused.value))


def test_a_finer_run_says_its_discretisation_error(page):
    computed(page)
    status = page.locator("#finer-status")
    page.locator("#grids").select_option("2")
    page.get_by_role("button", name="Run finer").click()
    expect(status).to_have_text(re.compile(r"\d"))
    expect(status).to_contain_text("discretisation error of COR at most 0.")
    assert page.locator("#finer-cor svg").count() > 0
    expect(page.locator("#take-of option").nth(1)).to_be_enabled()


def test_a_finer_run_can_be_cancelled_and_the_page_goes_on(page):
    computed(page)
    change(page, RMS, "21 nm")
    page.get_by_role("button", name="Run finer").click()
    expect(page.locator("#finer-status")).to_have_text(re.compile(r"\d"))
    page.get_by_role("button", name="Cancel").click()
    expect(page.locator("#finer-status")).to_have_text("cancelled")
    expect(page.get_by_role("button", name="Run finer")).to_be_enabled()
    change(page, RMS, "22 nm")


def test_many_impacts_are_run_in_beside_the_new_surfaces(page, live_case):
    computed(page)
    status, coverage = page.locator("#worn-status"), "#field-impacts-coverage"
    page.get_by_role("button", name="Run in").click()
    expect(status).to_contain_text("give a coverage")
    kept = live_case[: live_case.index("[indentation]")]
    page.locator("#case-file summary").click()
    page.locator("#case-text").fill(
        f'total_error = false\n{kept}[impact]\nvelocity = "0.3 m/s"\n[impacts]\n'
        "coverage = 0.001\nplaces = 2\n"
    )
    page.get_by_role("button", name="Use this text").click()
    expect(page.locator(f"{coverage}-problem")).to_contain_text("less than one contact")
    change(page, coverage, "0.2")
    page.get_by_role("button", name="Run in").click()
    expect(status).to_contain_text("coverage")
    expect(status).to_have_text(COMPLETE)
    assert page.locator("#worn-cor svg").count() > 0
    assert [float(row[1]) for row in table(page, "worn-numbers")] == approx([0, 0.2], abs=0.05)
    expect(page.locator("#take-of option[value=worn]")).to_be_enabled()


def drop(page, file):
    page.locator("#scan").set_input_files(file)


def expect_a_curve_or_a_message(page):
    expect(page.locator("#field-roughness-kind")).to_have_value("measured")
    expect(page.locator("#status")).to_have_text(re.compile("complete in|depths in|not computed"))
    if page.locator("#status").inner_text().startswith("not computed"):
        assert page.locator("#form .problem:visible").count() > 0


def test_a_scan_gives_a_curve(page):
    rest(page)
    drop(page, GLASS_BEAD)
    expect(page.locator("#field-roughness-file")).to_have_value("glass-bead.txt")
    expect_a_curve_or_a_message(page)
    rest(page)
    assert len(table(page, "numbers")) == 6


def test_a_scan_is_dropped_onto_the_page(page):
    rest(page)
    scan = page.evaluate_handle(
        "(text) => { const data = new DataTransfer();"
        " data.items.add(new File([text], 'dropped.txt')); return data; }",
        GLASS_BEAD.read_text(encoding="utf-8"),
    )
    page.dispatch_event("body", "dragover", {"dataTransfer": scan})
    expect(page.locator("#drop")).to_be_visible()
    page.dispatch_event("body", "drop", {"dataTransfer": scan})
    expect(page.locator("#drop")).to_be_hidden()
    expect(page.locator("#field-roughness-file")).to_have_value("dropped.txt")
    expect_a_curve_or_a_message(page)


@pytest.mark.parametrize(
    "name", ["mi-1.mi", "nid-1.nid", "di-3.di", "matrix-3.txt", "sur-2.sur", "tmd-1.tmd"]
)
def test_an_instrument_file_gives_a_curve_or_a_message(page, topographies, name):
    pytest.importorskip("SurfaceTopography", reason='the extra "measured" is not installed')
    computed(page)
    drop(page, topographies / name)
    expect_a_curve_or_a_message(page)


@pytest.mark.parametrize("name", ["di_corrupted.di", "nonsense_txt_file.txt"])
def test_a_damaged_instrument_file_is_told(page, topographies, name):
    expect_refused(page, topographies / name)


def expect_refused(page, file):
    rest(page)
    drop(page, file)
    expect(page.locator("#general")).to_contain_text(file.name)
    expect(page.locator("#status")).to_have_text("the scan was not read")
    assert page.locator("#field-roughness-kind").input_value() == "gaussian"
    assert page.locator(RMS).input_value() == "20 nm"


def test_a_file_that_is_no_scan_is_told_and_changes_nothing(page, tmp_path):
    (tmp_path / "letter.txt").write_text("Dear reader,\nthis is no scan.\n")
    expect_refused(page, tmp_path / "letter.txt")
    change(page, RMS, "23 nm")


def test_a_scan_without_its_size_asks_for_it(page, tmp_path):
    heights = 20e-9 * np.random.default_rng(1).standard_normal((32, 32))
    np.savetxt(tmp_path / "bare.txt", heights)
    computed(page)
    drop(page, tmp_path / "bare.txt")
    expect(page.locator("#field-roughness-size-problem")).to_contain_text("edge lengths")
    page.locator("#field-roughness-size").fill("8 um, 8 um")
    expect(page.locator("#field-roughness-size-problem")).to_be_hidden()
