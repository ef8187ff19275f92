"""The page of a surface: parameters with their standard names, figures with their numbers."""

import json
import re

import numpy as np
import pytest

from restitution import Grid, generate_surface
from tolerance import approx


@pytest.fixture
def described(cli, case_text, tmp_path):
    def call(*replacements):
        text = case_text
        for old, new in replacements:
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "case.toml").write_text(text)
        status, _, err = cli("surface", tmp_path / "case.toml", "-o", tmp_path / "out")
        assert status == 0, err
        page = (tmp_path / "out" / "surface.html").read_text()
        statistics = json.loads((tmp_path / "out" / "statistics.json").read_text())
        return re.sub(r"<script>/\*.*?</script>", "", page, flags=re.DOTALL), statistics

    return call


def cells(page, name):
    """The cells of the row that begins with `name`."""
    row = re.search(rf"<tr><td>{re.escape(name)}.*?</tr>", page, re.DOTALL)[0]
    return re.findall(r"<td[^>]*>(.*?)</td>", row)


def test_parameters_have_value_unit_clause_and_what_was_asked_for(described):
    page, statistics = described()
    assert cells(page, "root mean square height Sq")[1:] == ["50", "nm", "4.1.1", "50"]
    assert cells(page, "skewness Ssk")[4] == "0"
    assert cells(page, "autocorrelation length Sal")[2:4] == ["µm", "4.2.1"]
    assert float(cells(page, "core height Sk")[1]) == approx(1e9 * statistics["Sk_m"], rel=1e-4)
    # No lay, no direction.
    assert cells(page, "direction of slowest decay, from x")[1] == "–"


def test_a_lay_has_a_direction_beside_the_one_asked_for(described):
    page, _ = described(
        ('correlation_length = "2 um"', 'correlation_length = ["12 um", "2 um"]\nlay = "30 deg"')
    )
    found, _, _, asked = cells(page, "direction of slowest decay, from x")[1:]
    assert float(asked) == approx(30)
    assert float(found) == approx(30, abs=12)


def test_a_twin_stands_beside_its_scan(described, tmp_path):
    scan = generate_surface(
        Grid((64, 64), (0.5e-6, 0.6e-6)), kind="gaussian", rms=3e-8, correlation_length=4e-6, seed=1
    )
    np.save(tmp_path / "scan.npy", scan.height)
    page, _ = described(
        (
            'kind = "gaussian"\nrms = "0.05 um"\ncorrelation_length = "2 um"\nseed = 1',
            'kind = "measured"\nfile = "scan.npy"\nsize = ["32 um", "38.4 um"]\ndetrend = "tilt"\n'
            'extend = "twin"\nseed = 1',
        )
    )
    assert "not the scan itself" in page
    row = cells(page, "root mean square height Sq")
    assert float(row[5]) == approx(float(row[1]), rel=0.1)


def test_a_browser_draws_all_figures_of_a_hostile_case(opened, described, tmp_path):
    described(("A small rough contact", "</title><script>x()</script><b>"))
    drawn, console = opened(tmp_path / "out" / "surface.html")
    assert console == []
    assert 'data-drawn="4"' in drawn
    for title in ("Height map", "Distribution of heights", "Autocorrelation", "Power spectral"):
        assert re.search(rf"<h2[^>]*>{title}", drawn)


@pytest.mark.parametrize("nodes", ["[1, 1]", "[1, 40]", "[5, 4]"])
def test_smooth_and_tiny_surfaces_have_a_page(described, case_text, nodes):
    a, b = case_text.index("[roughness]"), case_text.index("[grid]")
    page, _ = described((case_text[a:b], ""), ("[72, 64]", nodes))
    assert cells(page, "root mean square height Sq")[1] == "0"
    assert cells(page, "skewness Ssk")[1] == "–"
