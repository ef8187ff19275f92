"""The page of `restitution app` in a browser: what a reader sees, changes and takes away."""

import csv
import json
import os
import re
import signal
import time
import warnings
import zipfile
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from restitution import api
from restitution.case.case_file import parse_case
from restitution.errors import CaseError
from tolerance import approx

expect = pytest.importorskip("playwright.sync_api", reason="playwright is not installed").expect

GLASS_BEAD = Path(__file__).parents[2] / "examples" / "glass-bead.txt"
COMPLETE = re.compile("^complete in ")
COMPUTED = re.compile(r"^(complete in|computing the errors|\d+ depths in)")
NUMBERS = {"restitution": 3, "force_N": 2, "impact_velocity_m_per_s": 0, "total_error": 5}
RMS = "#field-roughness-rms"


# ---- what the tests do and read --------------------------------------------------------------


def rest(page):
    """Wait until the whole run of the values in the form is drawn."""
    expect(page.locator("#status")).to_have_text(COMPLETE)


def computed(page):
    """Wait until the curve of the values in the form is drawn, with or without its errors."""
    expect(page.locator("#status")).to_have_text(COMPUTED)


def change(page, field, text):
    """Type `text` into a field, and wait until its curve is drawn."""
    page.locator(field).fill(text)
    computed(page)


def table(page, name):
    """The texts of a table, row by row."""
    found = page.locator(f"#{name} tbody tr").all()
    return [row.locator("td").all_inner_texts() for row in found]


def shown(page):
    """The numbers of the curve that the page shows, by the names of the columns of curve.csv."""
    page.get_by_text("The numbers of this curve").click()
    rows = table(page, "numbers")
    page.get_by_text("The numbers of this curve").click()
    return {name: [float(row[column]) for row in rows] for name, column in NUMBERS.items()}


def curve_of(results):
    """The rows of the curve.csv of a results folder, as numbers."""
    with open(results / "curve.csv", newline="") as file:
        return [{name: float(row[name]) for name in NUMBERS} for row in csv.DictReader(file)]


def run(text, folder):
    """The curve of a case file as the program computes it without a page."""
    (folder / "taken.toml").write_text(text)
    with warnings.catch_warnings(action="ignore"):
        api.run(folder / "taken.toml", out=folder / "taken")
    return curve_of(folder / "taken")


def taken(page, button, folder, tell=lambda page: None):
    """The file that a button of "Take away" gives."""
    tell(page)
    with page.expect_download() as got:
        page.get_by_role("button", name=button, exact=False).click()
    file = folder / got.value.suggested_filename
    got.value.save_as(file)
    return file


def names_in(archive):
    with zipfile.ZipFile(archive) as opened:
        return opened.namelist()


def drawn_curve(page):
    """The path of the first line of the COR plot."""
    return page.locator("#cor .scatterlayer path.js-line").first.get_attribute("d")


def refusal(text):
    """The message with which a case file is refused."""
    with pytest.raises(CaseError) as refused:
        parse_case(text)
    return str(refused.value)


# ---- the first page ---------------------------------------------------------------------------


def test_the_first_page_is_drawn_whole(page):
    rest(page)
    for plot in ("cor", "force", "pressure", "plastic", "surface"):
        assert page.locator(f"#{plot} svg").count() > 0, plot
    assert len(table(page, "numbers")) == 6
    assert [row[0] for row in table(page, "statistics")][:2] == ["nodes", "spacing"]
    assert "rms curvature" in [row[0] for row in table(page, "statistics")]
    expect(page.locator("#general")).to_be_hidden()
    label = page.locator("#cor").get_attribute("aria-label")
    assert re.match(r"Coefficient of restitution from 0\.\d+ to 0\.\d+ against impact", label)


def test_no_button_of_a_plot_sends_it_elsewhere(page):
    computed(page)
    titles = page.locator("#cor .modebar-btn")
    expect(titles.first).to_be_attached()
    found = [each.get_attribute("data-title") for each in titles.all()]
    assert "Download plot as a PNG" in found
    assert [each for each in found if "hare" in each or "loud" in each] == []


def test_the_curve_is_drawn_against_indentation_too(page):
    computed(page)
    before = page.locator("#cor .xtitle").text_content()
    page.get_by_role("radio", name="against indentation").check()
    expect(page.locator("#cor .xtitle")).not_to_have_text(before)
    assert "indentation" in page.locator("#cor .xtitle").text_content().lower()


# ---- sliders ----------------------------------------------------------------------------------


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


# ---- the exported case ------------------------------------------------------------------------


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


# ---- input that is wrong ----------------------------------------------------------------------


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
    expect(page.locator("#field-indentation-from-problem")).to_contain_text("give from, to and")
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
    expect(page.locator("#text-problem")).to_contain_text("no key of a case has such a value")


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


def test_a_case_as_a_text_fills_the_form(page, live_case):
    computed(page)
    page.locator("#case-file summary").click()
    page.locator("#case-text").fill(live_case.replace('"100 um"', '"120 um"'))
    page.get_by_role("button", name="Use this text").click()
    expect(page.locator("#field-first-radius")).to_have_value("120 um")
    computed(page)


# ---- pins and the cursor ----------------------------------------------------------------------


def test_pinned_curves_are_drawn_compared_and_removed(page):
    computed(page)
    drawn = page.locator("#cor .legendtext", has_text=re.compile("^pin "))
    page.get_by_role("button", name="Pin this curve").click()
    change(page, RMS, "40 nm")
    page.get_by_role("button", name="Pin this curve").click()
    assert [row[1] for row in table(page, "pins")] == ["the first one", "roughness.rms = 40 nm"]
    expect(drawn).to_have_text(["pin 1", "pin 2"])
    page.get_by_role("button", name="Remove pin 2").click()
    expect(drawn).to_have_text(["pin 1"])
    page.get_by_role("button", name="Go back to it").click()
    expect(page.locator(RMS)).to_have_value("20 nm")
    page.get_by_role("button", name="Remove pin 1").click()
    expect(page.locator("#no-pins")).to_be_visible()


def test_the_cursor_is_moved_by_arrow_keys(page):
    computed(page)
    page.locator("#cursor").focus()
    expect(page.locator("#maps-text")).to_contain_text("At an indentation of 200 nm")
    text, maps = (page.locator(each).inner_text() for each in ("#cursor-text", "#maps-text"))
    page.keyboard.press("ArrowLeft")
    expect(page.locator("#cursor-text")).not_to_have_text(text)
    expect(page.locator("#maps-text")).not_to_have_text(maps)
    page.keyboard.press("Home")
    expect(page.locator("#maps-text")).to_contain_text("At an indentation of 20 nm")
    expect(page.locator("#cursor-text")).to_contain_text(" 20 nm")


# ---- files to take away -----------------------------------------------------------------------


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


# ---- finer runs -------------------------------------------------------------------------------


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


# ---- scans ------------------------------------------------------------------------------------


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


# ---- several tabs, lost processes -------------------------------------------------------------


def test_two_tabs_compute_at_the_same_time(app, open_page):
    first, second = (open_page(app.address) for _ in range(2))
    first.locator(RMS).fill("24 nm")
    second.locator(RMS).fill("25 nm")
    for page in (first, second):
        rest(page)
    assert shown(first)["restitution"] != shown(second)["restitution"]


def start_a_heavy_solve(page):
    computed(page)
    page.locator("#field-grid-spacing").fill("20 nm")
    page.locator("#field-grid-nodes").fill("1536")
    expect(page.locator("#status")).to_have_text(re.compile("of 6 depths"))


def test_a_lost_process_is_told_and_started_anew(app, page):
    start_a_heavy_solve(page)
    for number in app.workers():
        os.kill(number, signal.SIGKILL)
    expect(page.locator("#general")).to_contain_text("has ended unexpectedly")
    expect(page.locator("#status")).to_have_text("stopped")
    page.locator("#field-grid-nodes").fill("64")
    change(page, "#field-grid-spacing", "250 nm")


@contextmanager
def held(app):
    """Workers that do not answer for so long that the server ends one with an unwanted solve."""
    workers = app.workers()
    for number in workers:
        os.kill(number, signal.SIGSTOP)
    yield
    time.sleep(2.5)  # more than the patience of live/process.py
    for number in workers:
        os.kill(number, signal.SIGCONT)


def test_a_change_during_a_long_solve_gives_the_curve_of_the_new_values(app, page):
    """A solve that nobody wants is ended; what came after it is computed nevertheless."""
    start_a_heavy_solve(page)
    with held(app):
        page.locator("#field-grid-nodes").fill("64")
        page.locator("#field-grid-spacing").fill("250 nm")
    computed(page)
    expect(page.locator("#general")).to_be_hidden()


def test_a_tab_that_is_closed_leaves_the_solve_of_another_alone(app, open_page):
    first, second = (open_page(app.address) for _ in range(2))
    computed(second)
    start_a_heavy_solve(first)
    with held(app):
        second.locator(RMS).fill("26 nm")
        expect(second.locator("#status")).to_have_text("computing…")
        second.close()
    computed(first)
    expect(first.locator("#general")).to_be_hidden()


def expect_gone(number):
    """Wait until the system has removed a process, which comes after its parent's end."""
    until = time.monotonic() + 5
    while Path(f"/proc/{number}").exists():
        assert time.monotonic() < until, number
        time.sleep(0.05)


def test_ctrl_c_ends_everything(own_app, open_page):
    page = open_page(own_app.address)
    start_a_heavy_solve(page)
    children = own_app.children()
    assert children
    assert list(own_app.folder.glob("restitution-app-*"))
    own_app.end()
    expect(page.locator("#general")).to_have_text(re.compile("^the program has ended"))
    for child in children:
        expect_gone(child)
    assert list(own_app.folder.glob("restitution-app-*")) == []


# ---- widths, colours, keyboard ----------------------------------------------------------------


@pytest.mark.parametrize("colours", ["light", "dark"])
@pytest.mark.parametrize("width", [1400, 820, 390])
def test_nothing_is_wider_than_the_window(app, open_page, width, colours):
    page = open_page(app.address, viewport={"width": width, "height": 900}, color_scheme=colours)
    rest(page)
    assert page.evaluate("() => document.documentElement.scrollWidth") <= width
    paper = page.evaluate("() => getComputedStyle(document.body).backgroundColor")
    assert (paper == "rgb(255, 255, 255)") == (colours == "light")


def test_every_input_has_a_name(page):
    computed(page)
    for each in page.locator("details").all():
        each.evaluate("(details) => { details.open = true; }")
    found = page.locator("input, select, textarea, button").filter(visible=True).all()
    assert len(found) > 40
    for each in found:
        expect(each).to_have_accessible_name(re.compile(r"\S"))


def test_the_keyboard_reaches_the_pin_a_field_and_a_slider(page):
    computed(page)
    reached = []
    for _ in range(12):
        page.keyboard.press("Tab")
        reached.append(page.locator(":focus").get_attribute("id"))
    wanted = ["pin", "field-first-material", "field-first-radius", "field-first-radius-slider"]
    assert [each for each in reached if each in wanted] == wanted
