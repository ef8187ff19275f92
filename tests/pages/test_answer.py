"""What stands first on a page, and numbers in words."""

import json
import math
import re
from dataclasses import replace

import pytest

from restitution.errors import DomainError
from restitution.laws.law_files import LAWS, write_law
from restitution.pages.answer import middle_of, round_velocities
from restitution.pages.many import write_mixture_page
from restitution.pages.words import column_unit, e_in_words, table_of, value_of
from tolerance import approx


@pytest.mark.parametrize(
    ("e", "error", "words"),
    [
        (0.523, 0.021, "0.52 ± 0.02"),
        (0.5234, 0.0021, "0.523 ± 0.002"),
        (0.5234, 1e-6, "0.523 ± 0.001"),
        (0.5, math.nan, "0.50 ± unknown"),
        (1.0, 0.31, "1.00 ± 0.31"),
    ],
)
def test_restitution_has_as_many_digits_as_its_error(e, error, words):
    assert e_in_words(e, error) == words


def test_round_velocities_lie_in_the_range():
    assert round_velocities(0.005, 1.0) == approx([0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0])
    assert round_velocities(0.0201, 0.0499) == []
    assert round_velocities(0.2 * (1 + 5e-5), 0.2 * (1 + 5e-5)) == approx([0.2])
    assert middle_of([0.01, 0.1, 0.2, 1.0]) == approx(0.1)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("yield_pressure_Pa", 8.4e8, "840 MPa"),
        ("deepest_indentation_m", 1e-6, "1 µm"),
        ("spacing", [1e-7, 2e-7], "100 nm × 200 nm"),
        ("nodes", [64, 32], "64, 32"),
        ("rms_curvature_per_m", 1.601e5, "1/(6.246 µm)"),
        ("lay_rad", math.pi / 6, "30°"),
        ("work_of_adhesion_J_per_m2", 0.05, "50 mJ/m²"),
        ("seed", 1, "1"),
        ("resolved", True, "yes"),
        ("below_grid", {}, "none"),
        ("sticking_velocity_m_per_s", None, "–"),
    ],
)
def test_stored_values_have_units_with_prefixes(key, value, words):
    assert value_of(key, value) == words


def test_names_are_those_of_check():
    (row,) = table_of("Derived", {"yield_pressure_Pa": 2.1e9}).rows
    assert row == ["yield pressure p_y", "2.1 GPa"]
    scale, unit = column_unit([1.4e-5, 2e-6, math.nan], "N")
    assert (scale, unit) == (approx(1e6), "µN")


@pytest.fixture
def mixture(tmp_path, law):
    """The page of a mixture of beads of different sizes and a wall, from laws made by hand."""

    def make(sizes, velocity=None, materials=("glass",)):
        ball = law().first
        radii = [1e-4 * 1.3**k for k in range(sizes)]
        beads = [replace(ball, name=name, radius=R) for name in materials for R in radii]
        wall = replace(ball, name="drum", radius=None)
        pairs = [(a, b) for k, a in enumerate(beads) for b in (*beads[k:], wall)]
        laws = [law(a, b, at=1 + k / 10) for k, (a, b) in enumerate(pairs)]
        for k, one in enumerate(laws):
            folder = tmp_path / LAWS / f"pair-{k:03d}"
            folder.mkdir(parents=True)
            write_law(one, folder)
        (tmp_path / "mixture.toml").write_text("title = 'Beads'")
        summary = {"title": "Beads", "pairs": len(laws), "curves_computed": 3, "warnings": []}
        (tmp_path / "summary.json").write_text(json.dumps(summary))
        return write_mixture_page(tmp_path, velocity), laws

    return make


def cells(text):
    """The texts of the rows of the first table."""
    table = text[text.index("<table>") : text.index("</table>")]
    rows = re.findall(r"<tr>(.*?)</tr>", table)
    return [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in rows]


def test_a_mixture_has_a_matrix_of_restitution_at_a_chosen_velocity(mixture):
    page, laws = mixture(2, 0.3)
    text = page.read_text()
    assert "<option selected>300 mm/s</option>" in text
    head, *rows = cells(text)
    glass = "glass, R = 100 µm", "glass, R = 130 µm"
    assert head == ["", *glass, "drum, flat"]
    in_words = [e_in_words((one := law.at(0.3)).restitution, one.error) for law in laws]
    assert [row[0] for row in rows] == [*glass]
    assert rows[0][1:] == [in_words[0], in_words[1], in_words[2]]
    assert rows[1][1:] == [in_words[1], in_words[3], in_words[4]]
    e = [law.at(0.3).restitution for law in laws]
    assert f'class="answer">e from {min(e):.2f} to {max(e):.2f} at 300 mm/s<' in text
    assert text.count("<h2>glass on glass</h2>") == 1


def test_a_velocity_that_no_pair_has_is_refused(mixture):
    with pytest.raises(DomainError, match="outside the computed velocities"):
        mixture(2, 30.0)


def test_a_large_mixture_has_a_page_of_under_one_megabyte(mixture):
    page, laws = mixture(19)
    assert len(laws) == 209
    assert page.stat().st_size < 2**20


def test_a_mixture_of_many_materials_prints_on_two_sheets(mixture, printed):
    page, laws = mixture(2, materials=("glass", "steel", "lactose", "sand"))
    assert len({(law.first.name, law.second.name) for law in laws}) == 14
    assert printed(page) == 2


def test_readers_choose_the_velocity(mixture, opened):
    page, laws = mixture(2, 0.3)
    select = """<script>
      const choose = document.getElementById("choice");
      choose.value = "1 m/s"; choose.dispatchEvent(new Event("change"));</script>"""
    page.write_text(page.read_text().replace("</body>", select + "</body>"))
    drawn, console = opened(page)
    assert console == []
    one = laws[0].at(1.0)
    assert cells(drawn)[1][1] == e_in_words(one.restitution, one.error)
