"""A self-contained page: figures that can be read out, the numbers behind them, and tables.

No request leaves the file: the drawing library is part of it, and its security policy allows none.
Texts of users are escaped by the template.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from plotly.graph_objects import Figure as Plot
from plotly.offline import get_plotlyjs

from restitution.results.writer import replace_file

Cell = str | float | int | None


@dataclass(frozen=True)
class Table:
    """Rows of cells under column names, with lines of text before them."""

    title: str
    columns: Sequence[str] = ()
    rows: Sequence[Sequence[Cell]] = ()
    text: Sequence[str] = ()


@dataclass(frozen=True)
class Listing:
    """A text as it stands in a file."""

    title: str
    content: str


@dataclass(frozen=True)
class Drawing:
    """A figure: what it shows in words (`alt`), how to read it (`caption`), and its numbers."""

    title: str
    plot: Plot
    alt: str
    caption: str
    table: Table
    square: bool = False


@dataclass(frozen=True)
class Page:
    """A title, lines under it, warnings, and the parts that follow."""

    title: str
    intro: Sequence[str] = ()
    warnings: Sequence[str] = ()
    parts: Sequence[Table | Drawing | Listing] = field(default_factory=list)


def write_page(path: Path, page: Page) -> None:
    """Write `page` as one HTML file, all of it or nothing. Raises `OutputError`."""
    text = _environment().get_template("page.html").render(page=page, plotly=_plotly())
    replace_file(path, lambda to: to.write_text(text, encoding="utf-8"))


def new_plot(x: str, y: str) -> Plot:
    """An empty figure with titles (plain text) on its axes, in the style of all."""
    plot = Plot()
    plot.update_layout(
        template="none",
        paper_bgcolor="rgba(0,0,0,0)",
        plot_bgcolor="rgba(0,0,0,0)",
        margin={"l": 70, "r": 20, "t": 20, "b": 60},
        legend={"orientation": "h", "y": -0.22, "yanchor": "top"},
        font={"family": "system-ui, sans-serif", "size": 13},
        hovermode="closest",
        modebar={"bgcolor": "rgba(0,0,0,0)", "color": "#8c959f", "activecolor": "#57606a"},
    )
    plot.update_xaxes(title=x, showline=True, ticks="outside")
    plot.update_yaxes(title=y, showline=True, ticks="outside")
    return plot


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("restitution.reports"), autoescape=True, undefined=StrictUndefined
    )
    environment.filters["cell"] = _cell
    environment.filters["script"] = lambda plot: _within_script(plot.to_json())
    return environment


def _cell(value: Cell) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    return value if isinstance(value, str) else f"{value:.5g}"


@cache
def _plotly() -> Markup:
    return Markup(get_plotlyjs())


def _within_script(json: str) -> Markup:
    """JSON that cannot end the script element it stands in."""
    return Markup(json.replace("<", "\\u003c"))
