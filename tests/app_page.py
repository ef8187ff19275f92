"""What the tests of the live page do on it, and what they read from it."""

import csv
import re
import warnings
import zipfile
from pathlib import Path

import pytest

from restitution import api
from restitution.case.case_file import parse_case
from restitution.errors import CaseError

expect = pytest.importorskip("playwright.sync_api", reason="playwright is not installed").expect

GLASS_BEAD = Path(__file__).parents[1] / "examples" / "glass-bead.txt"
COMPLETE = re.compile("^complete in ")
COMPUTED = re.compile(r"^(complete in|computing the errors|\d+ depths in)")
NUMBERS = {"restitution": 3, "force_N": 2, "impact_velocity_m_per_s": 0, "total_error": 5}
RMS = "#field-roughness-rms"


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
    rows = page.locator(f"#{name} tbody tr").all()
    return [row.locator("td").all_inner_texts() for row in rows]


def shown(page):
    """The numbers of the curve that the page shows, by the names of the columns of curve.csv."""
    rows = [row.locator("td").all() for row in page.locator("#numbers tbody tr").all()]
    return {
        name: [float(row[column].get_attribute("data-value")) for row in rows]
        for name, column in NUMBERS.items()
    }


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
