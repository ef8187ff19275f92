"""`restitution report`: a page of whatever a folder holds."""

import json
import re
from urllib.parse import unquote

import pytest

import axe
from restitution.laws.from_results import bare_law
from restitution.pages.words import e_in_words

LARGEST = 2**20  # bytes of a page
HOSTILE = "</title><script>document.title = 'hacked'</script><b>$x$"


@pytest.fixture
def reported(cli, case_text, tmp_path):
    def call(verb, text=case_text, *more):
        (tmp_path / "case.toml").write_text(text.replace("A small rough contact", HOSTILE))
        status, _, said = cli(verb, tmp_path / "case.toml", "-o", tmp_path / "out", *more)
        assert status == 0, said
        status, said, _ = cli("report", tmp_path / "out")
        assert status == 0
        page = tmp_path / "out" / ("surface.html" if verb == "surface" else "report.html")
        assert str(page) in said
        return page

    return call


def own(page):
    """The page without the drawing library."""
    return re.sub(r"<script>/\*.*?</script>", "", page.read_text(), flags=re.DOTALL)


def test_a_run(reported, opened):
    page = reported("run")
    drawn, console = opened(page)
    assert console == []
    assert 'data-drawn="5"' in drawn
    text = own(page)
    for words in (
        "Restitution against maximum indentation",
        "Contact pressure",
        "Case file",
        "Love (1929)",
        "Derived quantities",
        "largest residual",
    ):
        assert words in text
    assert "<script>document" not in text
    plots = re.findall(r'<div class="plot[^>]*>', text)
    assert len(plots) == 5
    assert all(re.search(r'role="img" aria-label="[^"]{20,}"', plot) for plot in plots)


def test_an_ensemble(reported, case_text, opened):
    page = reported("run", case_text.replace("seed = 1", "seed = 1\nrealisations = 2"))
    drawn, console = opened(page, width=400)
    assert console == []
    assert 'data-drawn="4"' in drawn
    assert "95 % interval of the mean" in own(page)
    assert "means of 2 surfaces" in own(page)


def test_a_convergence(reported):
    text = own(reported("converge"))
    assert "largest discretisation error" in text
    assert "on grids refined 1, 2, 4 times" in text


def test_a_study(reported, case_text, opened):
    sweep = '[sweep]\n"indentation.to" = ["300 nm", "30 um"]\n"title" = ["<i>a</i>"]\n'
    page = reported("study", case_text + sweep, "--workers", "1")
    drawn, console = opened(page)
    assert console == []
    assert 'data-drawn="2"' in drawn
    text = own(page)
    assert "1 complete, 1 failed" in text
    assert "1 cases failed and 0 are missing" in text
    assert "edge of the" in text
    assert "<i>a</i>" not in text.replace("\\u003c", "?")


def test_a_surface(reported):
    assert "Height map" in own(reported("surface"))


def test_a_run_that_was_stopped_has_a_page(reported, case_text, cli, tmp_path):
    (tmp_path / "case.toml").write_text(case_text.replace('to = "300 nm"', 'to = "9 um"'))
    status, _, _ = cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert status == 1
    assert cli("report", tmp_path / "out")[0] == 0
    assert "failed: the contact" in own(tmp_path / "out" / "report.html")


def test_what_is_no_folder_of_results(refused, reported, tmp_path):
    assert "holds no results" in refused("report", tmp_path)
    assert "holds no results" in refused("report", tmp_path / "nothing")
    page = reported("run")
    (page.parent / "summary.json").write_text("{}")
    assert "summary.json: is damaged" in refused("report", page.parent)


def answer(text):
    return re.search(r'<p class="answer">(.*?)</p>', text)[1]


def tables(text):
    """The texts of the cells of all tables, row by row, by the heading or summary above each."""
    return [
        [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in re.findall(r"<tr>.*?</tr>", one)]
        for one in re.findall(r"<table>.*?</table>", text, re.DOTALL)
    ]


def at_velocities(text, *replacements):
    """The case with impact velocities from 0.03 to 0.3 m/s."""
    begin, end = text.index("[indentation]"), text.index("[unloading]")
    text = text[:begin] + '[impact]\nfrom = "0.03 m/s"\nto = "0.3 m/s"\nsteps = 4\n' + text[end:]
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new)
    return text


def test_the_answer_comes_first_at_any_computed_velocity(reported, case_text, cli, refused):
    page = reported("run", at_velocities(case_text))
    text = own(page)
    assert re.fullmatch(r"e = 0\.\d+ ± 0\.\d+ at 100 mm/s", answer(text))
    assert "R = 500 µm" in text
    rows = tables(text)[0]
    assert [row[0] for row in rows[1:]] == ["50 mm/s", "100 mm/s", "200 mm/s"]
    assert answer(text) == f"e = {rows[2][1]} at 100 mm/s"
    assert text.index("answer") < text.index("Restitution against impact velocity")
    assert cli("report", page.parent, "--velocity", "0.3 m/s")[0] == 0
    last = bare_law(page.parent).points[-1]
    assert answer(own(page)) == f"e = {e_in_words(last.restitution, last.error)} at 300 mm/s"
    assert "outside the computed velocities" in refused(
        "report", page.parent, "--velocity", "9 m/s"
    )


def test_numbers_have_prefixes_and_details_are_folded(reported, case_text):
    text = own(reported("run", at_velocities(case_text)))
    assert "yield pressure p_y</td><td>750 MPa" in text
    assert not re.search(r">\w+_(m|Pa|N|J|kg)<", text)
    before = text[: text.index("<h2>Details</h2>")]
    for title in ("Derived quantities", "Conventions", "Origin of the surface", "Methods"):
        assert f"<summary>{title}</summary>" in text
        assert title not in before


ADHESIVE = """
title = "A small rough contact"
total_error = false
[first]
radius = "5 um"
youngs_modulus = "3 GPa"
poissons_ratio = 0.35
density = "1050 kg/m^3"
[interface]
yield_pressure = "elastic"
work_of_adhesion = "0.05 J/m^2"
adhesion = "jkr"
[grid]
nodes = 24
spacing = "80 nm"
[impact]
velocity = "0.2 m/s"
"""


def test_an_adhesive_run_states_pull_off_and_sticking(reported):
    text = own(reported("run", ADHESIVE))
    before = text[: text.index("<figure>")]
    assert re.search(r"<p>Sticks below [\d.]+ ± [\d.]+ mm/s; pull-off force \d", before)
    assert "; smooth</p>" in before


def test_a_report_is_small_prints_to_two_pages_and_has_no_serious_fault(
    reported, case_text, printed, opened
):
    page = reported("run", at_velocities(case_text))
    assert page.stat().st_size < LARGEST
    assert printed(page) == 2
    assert faults(page, opened) == []
    text = page.read_text()
    assert "(prefers-color-scheme: dark)" in text
    page.write_text(text.replace("@media (prefers-color-scheme: dark)", "@media all"))
    assert faults(page, opened) == []


def faults(page, opened):
    """The serious faults that axe-core finds on a page."""
    checked = page.with_name("checked.html")
    run = f"""<script>{axe.script()}</script><script>
      const drawn = () => document.body.dataset.drawn ? {axe.RUN}.then((faults) => {{
        document.body.dataset.faults = encodeURIComponent(JSON.stringify(faults));
      }}) : setTimeout(drawn, 50);
      drawn();</script>"""
    checked.write_text(page.read_text().replace("</body>", run + "</body>"))
    found = re.search(r'data-faults="([^"]*)"', opened(checked)[0])
    return json.loads(unquote(found[1]))
