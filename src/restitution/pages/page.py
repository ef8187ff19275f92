"""A self-contained HTML page: the answer, accessible figures, their numbers, and tables.

The page contains the plotting library and makes no requests; its security policy forbids requests.
The template escapes texts from users.
"""

from __future__ import annotations

import base64
import gzip
import json
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from restitution.plots import interactive, library
from restitution.plots.figure import Figure, Map, legend_entries
from restitution.results.writer import replace_file


@dataclass(frozen=True)
class ChosenCell:
    """A cell whose text depends on the option that the reader selects (`Choice`)."""

    number: int


Cell = str | float | int | ChosenCell | None


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
class Choice:
    """Tables with cells that change with an option, which the reader selects by its `label`.

    All tables but the first are folded.
    `texts[option][number]` is the text of the cells `ChosenCell(number)`; `chosen` is the option
    shown at first.
    """

    label: str
    options: Sequence[str]
    texts: Sequence[Sequence[str]]
    tables: Sequence[PageTable]
    chosen: int = 0


@dataclass(frozen=True)
class Answer:
    """What a reader wants to know first: one line, further `facts`, and a table."""

    line: str = ""
    facts: Sequence[str] = ()
    table: PageTable | None = None
    choice: Choice | None = None


@dataclass(frozen=True)
class Page:
    """A page: title, introductory lines, `answer`, two figures (`top`), warnings, parts.

    `details` are folded until a reader opens them, and left out in print.
    """

    title: str
    intro: Sequence[str] = ()
    warnings: Sequence[str] = ()
    parts: Sequence[PageTable | Drawing | Listing] = ()
    answer: Answer = Answer()
    top: Sequence[Drawing] = ()
    details: Sequence[PageTable | Listing] = ()


def write_page(path: Path, page: Page) -> Path:
    """Write `page` atomically as one HTML file, and return the file. Raises `OutputError`."""
    environment = Environment(
        loader=PackageLoader("restitution.pages"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    drawings = [*page.top, *(part for part in page.parts if isinstance(part, Drawing))]
    specs: list[str] = []
    plots = {id(drawing): list(_plots(drawing.figure, specs)) for drawing in drawings}
    environment.filters |= {"cell": _cell, "numeric": _numeric}
    texts = page.answer.choice.texts if page.answer.choice else []
    text = environment.get_template("page.html").render(
        page=page,
        plots=lambda drawing: plots[id(drawing)],
        library=base64.b64encode(library.compressed()).decode(),
        figures=_packed(f"[{','.join(specs)}]"),
        texts=_packed(json.dumps(texts)),
    )
    replace_file(path, lambda to: to.write_text(text, encoding="utf-8"))
    return path


def _packed(text: str) -> str:
    return base64.b64encode(gzip.compress(text.encode(), 9)).decode()


def _plots(figure: Figure, specs: list[str]) -> Iterator[dict[str, Any]]:
    """Append the JSON of each panel to `specs`, and yield what the template needs of it."""
    for panel in figure.panels:
        specs.append(interactive.draw(panel, figure).to_json())
        yield {
            "number": len(specs) - 1,
            "title": panel.title,
            "square": isinstance(panel, Map),
            "entries": len(legend_entries(panel)),
        }


_NUMBER = re.compile(
    r"[–-]|unknown|[-+]?\d[\d.,e+-]*( ± (<?[\d.e-]+|unknown))?( ?[^\s\d]{1,8})?|\d+ of \d+"
)


def _numeric(table: PageTable) -> list[bool]:
    """Whether each column has numbers alone, which are aligned to the right.

    In a table of names and values, the values stand beside their names.
    """
    columns = list(zip(*table.rows, strict=True)) or [("",)] * len(table.columns)
    numeric = [
        all(not isinstance(cell, str) or _NUMBER.fullmatch(cell) for cell in column)
        for column in columns
    ]
    return [False, False] if numeric == [False, True] else numeric


def _cell(value: Cell) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    return value if isinstance(value, str) else f"{value:.5g}"
