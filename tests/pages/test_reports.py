"""`restitution report`: a page of whatever a folder holds."""

import re

import pytest

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
