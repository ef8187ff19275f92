"""The page for readers with a keyboard or a screen reader, and six questions that it answers."""

import re

import pytest

from app_page import computed, expect, rest
from axe import script


@pytest.fixture(scope="session")
def axe():
    return script()


@pytest.mark.parametrize(("width", "scheme"), [(1440, "light"), (390, "dark")])
def test_axe_finds_no_serious_fault(app, open_page, axe, width, scheme):
    page = open_page(app.address, viewport={"width": width, "height": 900}, color_scheme=scheme)
    rest(page)
    page.evaluate("for (const one of document.querySelectorAll('details')) one.open = true")
    page.get_by_role("button", name="What is e?").click()
    page.evaluate(axe)
    faults = page.evaluate("async () => (await axe.run()).violations")
    serious = [
        (fault["id"], fault["help"], [node["html"][:120] for node in fault["nodes"][:3]])
        for fault in faults
        if fault["impact"] in ("serious", "critical")
    ]
    assert serious == []


def test_a_wrong_name_is_found_by_axe(app, open_page, axe):
    """The check above can fail."""
    page = open_page(app.address)
    computed(page)
    page.evaluate("document.getElementById('pin').textContent = ''")
    page.evaluate(axe)
    faults = page.evaluate("async () => (await axe.run()).violations.map((fault) => fault.id)")
    assert "button-name" in faults


def tab_to(page, target, most=150):
    """Press the tabulator until the element with this id, name or text has the focus."""
    for _ in range(most):
        page.keyboard.press("Tab")
        here = page.evaluate(
            "() => { const e = document.activeElement;"
            " return [e.id, e.textContent, e.getAttribute('data-take')]; }"
        )
        if target in here:
            return
    raise AssertionError(f"{target} is not reached")


def test_keyboard_alone_from_opening_to_an_export(new_page, tmp_path):
    computed(new_page)
    tab_to(new_page, "field-first-radius")
    new_page.keyboard.press("Control+A")
    new_page.keyboard.type("90 um")
    tab_to(new_page, "answer-velocity")
    new_page.keyboard.press("Control+A")
    new_page.keyboard.type("50 mm/s")
    computed(new_page)
    expect(new_page.locator("#answer-value")).to_have_text(re.compile(r"^e . 0\.\d"))
    tab_to(new_page, "code")
    assert new_page.locator("#code").input_value() == "lammps"
    tab_to(new_page, "export")
    with new_page.expect_download() as got:
        new_page.keyboard.press("Enter")
    assert got.value.suggested_filename == "lammps.zip"


class Clicks:
    """Clicks on the page, which are counted; typing in a field counts one."""

    def __init__(self, page):
        self.page, self.count = page, 0

    def press(self, name):
        self.count += 1
        self.page.get_by_role("button", name=name, exact=True).first.click()

    def choose(self, field, label):
        self.count += 1
        self.page.locator(field).select_option(label=label)

    def type(self, field, text):
        self.count += 1
        self.page.locator(field).fill(text)


@pytest.fixture
def asked(app, open_page):
    """The page as it opens without a case, in a tab of its own."""
    page = open_page(app.address)
    expect(page.locator("#preset")).to_be_visible()
    expect(page.locator("#field-first-material")).to_be_visible()
    return Clicks(page)


def answer(page, words, part="#answer"):
    expect(page.locator(part)).to_contain_text(re.compile(words))


def begin(asked, preset):
    asked.choose("#preset", preset)


def test_e_of_two_steel_beads_at_1_m_per_s(asked):
    begin(asked, "Steel bead")
    expect(asked.page.locator("#answer-velocity")).to_have_value("1 m/s")
    answer(asked.page, r"e (=|≈) 0\.9\d")
    assert asked.count == 1


def test_does_my_powder_stick(asked):
    begin(asked, "Lactose powder")
    answer(asked.page, r"Sticks\s*below about \d+ mm/s", "#answer-facts")
    answer(asked.page, r"Pull-off force\s*[\d.]+( ± [\d.]+)? nN", "#answer-facts")
    assert asked.count == 1


def test_what_changes_if_i_polish(asked):
    page = asked.page
    computed(page)
    asked.press("Pin this curve")
    asked.type("#field-roughness-rms", "5 nm")
    computed(page)
    answer(page, r"e = 0\.\d+")
    expect(page.locator("#cor .legendtext", has_text="pin 1")).to_have_count(1)
    assert asked.count == 2


def test_the_lammps_line(asked):
    page = asked.page
    computed(page)
    asked.press("Show the lines")
    answer(page, r"pair_coeff \d+ \d+ ", "#code-lines")
    assert asked.count == 1


def test_is_my_scan_good_enough(asked, tmp_path):
    import numpy as np

    rng = np.random.default_rng(2)
    waves = rng.standard_normal((64, 64))
    smooth = np.fft.ifft2(np.fft.fft2(waves) * np.exp(-((np.fft.fftfreq(64)[:, None] ** 2
        + np.fft.fftfreq(64)[None, :] ** 2) * 600))).real  # fmt: skip
    np.savetxt(tmp_path / "scan.txt", 20e-9 * smooth / smooth.std())
    page = asked.page
    computed(page)
    asked.count += 1
    page.locator("#scan").set_input_files(tmp_path / "scan.txt")
    expect(page.locator("#field-roughness-size-problem")).to_contain_text("edge lengths")
    asked.type("#field-roughness-size", "16 um, 16 um")
    answer(page, r"Grid\s*(resolved ✓|not resolved at \d+ of \d+ depths)", "#answer-facts")
    assert asked.count == 2


def test_virgin_or_run_in(asked):
    page = asked.page
    computed(page)
    asked.choose("#field-depths", "impact velocities")
    asked.type("#answer-velocity", "0.2 m/s")
    answer(page, r"e . 0\.\d+")
    asked.press("Compute run-in")
    answer(page, r"After run-in\s*e = 0\.\d+.*; new: 0\.\d+", "#answer-facts")
    assert asked.count == 3
