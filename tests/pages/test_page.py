"""Pages: what is in the file, and what a real browser makes of it."""

import re

import numpy as np
import pytest

from restitution.pages.page import Drawing, Page, PageTable, write_page
from restitution.plots.figure import Axis, Chart, Figure, Line

HOSTILE = '</script><script>document.title = "hacked"</script><img src=x onerror=alert(1)> & "'


def page(title="A page", cell="cell"):
    line = Line(np.arange(5.0), np.arange(5.0) ** 2, cell)
    figure = Figure(title, [Chart(Axis("x", "µm"), Axis("y"), [line], title=cell)])
    table = PageTable("Numbers", ["x", "y"], [[float(k), float(k * k)] for k in range(5)])
    return Page(
        title,
        [f"About {cell}"],
        [f"Beware of {cell}"],
        [
            Drawing("A figure", figure, f"Squares, {cell}", "How to read it", table),
            PageTable(
                "A table", ["name", cell], [[cell, 1.5], ["none", None], ["nan", float("nan")]]
            ),
        ],
    )


def test_a_page_holds_titles_figures_and_tables(tmp_path):
    write_page(tmp_path / "page.html", page())
    text = (tmp_path / "page.html").read_text()
    assert "<title>A page</title>" in text
    assert 'role="img" aria-label="Squares, cell"' in text
    assert '<td class="number">16</td>' in text
    assert text.count("<td>–</td>") + text.count('<td class="number">–</td>') == 2


def test_nothing_is_requested_from_outside(tmp_path):
    write_page(tmp_path / "page.html", page())
    text = (tmp_path / "page.html").read_text()
    assert "default-src 'none'" in text
    own = re.sub(r"<script>/\*.*?</script>", "", text, flags=re.DOTALL)
    assert not re.search(r"(src|href)=", own)
    assert len(own) < 60_000


def test_texts_of_users_are_escaped(tmp_path):
    write_page(tmp_path / "page.html", page(HOSTILE, HOSTILE))
    text = (tmp_path / "page.html").read_text()
    own = re.sub(r"<script>/\*.*?</script>", "", text, flags=re.DOTALL)
    assert "<img" not in own
    assert own.count("</script>") == own.count("<script")


@pytest.mark.parametrize("width", [1200, 400])
def test_a_browser_draws_it_and_does_not_complain(opened, tmp_path, width):
    write_page(tmp_path / "page.html", page(HOSTILE, HOSTILE))
    drawn, console = opened(tmp_path / "page.html", width=width)
    assert console == []
    assert 'data-drawn="1"' in drawn
    assert "main-svg" in drawn
    assert "<title>hacked" not in drawn
    assert "<img src=" not in drawn.split("<main>")[1].split("</main>")[0]
