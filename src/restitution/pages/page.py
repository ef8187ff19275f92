"""A self-contained HTML page: accessible figures, their numbers, and tables.

The page contains the plotting library and makes no requests; its security policy forbids requests.
The template escapes texts from users.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from restitution.plots import interactive
from restitution.plots.figure import Figure, Map, legend_entries
from restitution.results.writer import replace_file

Cell = str | float | int | None


@dataclass(frozen=True)
class PageTable:
    """A table with column names and rows of cells; lines of `text` precede it."""

    title: str
    columns: Sequence[str] = ()
    rows: Sequence[Sequence[Cell]] = ()
    text: Sequence[str] = ()


@dataclass(frozen=True)
class Listing:
    """The verbatim text of a file."""

    title: str
    content: str


@dataclass(frozen=True)
class Drawing:
    """A figure with a text alternative (`alt`), a `caption`, and a table of its numbers."""

    title: str
    figure: Figure
    alt: str
    caption: str
    table: PageTable


@dataclass(frozen=True)
class Page:
    """The content of a page: title, introductory lines, warnings and parts."""

    title: str
    intro: Sequence[str] = ()
    warnings: Sequence[str] = ()
    parts: Sequence[PageTable | Drawing | Listing] = ()


def write_page(path: Path, page: Page) -> Path:
    """Write `page` atomically as one HTML file, and return the file. Raises `OutputError`."""
    environment = Environment(
        loader=PackageLoader("restitution.pages"), autoescape=True, undefined=StrictUndefined
    )
    environment.filters |= {"cell": _cell, "plots": _plots}
    template = environment.get_template("page.html")
    text = template.render(page=page, plotly=Markup(get_plotlyjs()))
    replace_file(path, lambda to: to.write_text(text, encoding="utf-8"))
    return path


def _plots(figure: Figure) -> list[dict[str, Any]]:
    """Prepare each panel for the template: Plotly JSON, title, shape, number of legend entries."""
    return [
        {
            # Escape "<", so that no text in the JSON can end the script element that contains it.
            "script": Markup(interactive.draw(panel, figure).to_json().replace("<", "\\u003c")),
            "title": panel.title,
            "square": isinstance(panel, Map),
            "entries": len(legend_entries(panel)),
        }
        for panel in figure.panels
    ]


def _cell(value: Cell) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    return value if isinstance(value, str) else f"{value:.5g}"
