"""The page of a study: restitution of every case, and what became of each."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

from plotly.graph_objects import Scatter

from restitution.case.case_file import parse_toml
from restitution.contact.checks.resolution import NODES_PER_PATCH
from restitution.reports.methods import methods
from restitution.reports.page import Cell, Drawing, Listing, Page, Table, new_plot, write_page
from restitution.results.reader import StoredCase, StudyResults

_MOST_LINES = 60  # in one figure: more cannot be told apart


def write_study_page(out: Path) -> Path:
    """Write `report.html` from the `table.csv`, `study.nc` and cases in `out`."""
    study = StudyResults(out)
    cases, text = study.cases, study.text
    title = str(parse_toml(text).get("title", ""))
    swept = list(cases[0].swept)
    count = {status: sum(case.status == status for case in cases)
             for status in ("complete", "failed", "missing")}  # fmt: skip
    parts: list[Table | Drawing | Listing] = []
    if count["complete"]:
        parts.append(_restitution(cases, swept, "indentation_m", 1e6, "maximum indentation", "µm"))
        if any(_has(row, "impact_velocity_m_per_s") for case in cases for row in case.curve.rows):
            parts.append(
                _restitution(cases, swept, "impact_velocity_m_per_s", 1.0, "impact velocity", "m/s")
            )
    parts += [_cases(cases, swept), Listing("Study file", text)]
    complete = next((case.name for case in cases if case.status == "complete"), None)
    if complete is not None:
        parts.append(methods(study.run(complete).summary))
    page = Page(
        title=title or "Study",
        intro=[
            f"{len(cases)} cases over {', '.join(swept)}: "
            + ", ".join(f"{number} {status}" for status, number in count.items() if number)
        ],
        warnings=_warnings(cases, count),
        parts=parts,
    )
    write_page(out / "report.html", page)
    return out / "report.html"


def _warnings(cases: list[StoredCase], count: dict[str, int]) -> list[str]:
    found = []
    resolved = [row["resolved"] for case in cases for row in case.curve.rows]
    few = len(resolved) - int(sum(resolved))
    if few:
        found.append(
            f"{few} of {len(resolved)} depths are not resolved: "
            f"half of their contact is in patches of fewer than {NODES_PER_PATCH} nodes, and their "
            "numbers belong to the grid"
        )
    if count["failed"] or count["missing"]:
        found.append(
            f"{count['failed']} cases failed and {count['missing']} are missing; reasons are in "
            "the table of cases"
        )
    return found


def _restitution(
    cases: list[StoredCase],
    swept: list[str],
    column: str,
    scale: float,
    words: str,
    unit: str,
) -> Drawing:
    plot = new_plot(f"{words} ({unit})", "coefficient of restitution")
    plot.update_xaxes(type="log", exponentformat="power")
    plot.update_yaxes(range=[0, 1.05])
    drawn = [case for case in cases if case.status == "complete"]
    table: list[list[Cell]] = []
    for number, case in enumerate(drawn):
        rows = [row for row in case.curve.rows if _has(row, column)]
        x = [scale * row[column] for row in rows]
        y = [row["restitution"] for row in rows]
        resolved = ["true" if row["resolved"] else "false" for row in rows]
        name = ", ".join(f"{key.rsplit('.', 1)[-1]} {value}" for key, value in case.swept.items())
        table += [
            [*case.swept.values(), a, b, yes] for a, b, yes in zip(x, y, resolved, strict=True)
        ]
        if number < _MOST_LINES and rows:
            open_or_not = ["circle" if row["resolved"] else "circle-open" for row in rows]
            plot.add_trace(
                Scatter(x=x, y=y, mode="lines+markers", name=_escaped(name),
                        marker={"symbol": open_or_not, "size": 7})
            )  # fmt: skip
    few = "" if len(drawn) <= _MOST_LINES else f" The first {_MOST_LINES} of {len(drawn)} cases."
    return Drawing(
        f"Restitution against {words}",
        plot,
        f"Coefficient of restitution against {words}, a line for each of "
        f"{min(len(drawn), _MOST_LINES)} cases",
        f"Open markers: not resolved by the grid. A click in the legend hides a case.{few}",
        Table("Restitution", [*swept, f"{words} ({unit})", "COR", "resolved"], table),
    )


def _has(row: Mapping[str, float], column: str) -> bool:
    """Whether the cell of `row` in `column` has a number."""
    return not math.isnan(row[column])


def _escaped(text: str) -> str:
    """A text of the user's where the figures would read markup in it."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _cases(cases: list[StoredCase], swept: list[str]) -> Table:
    rows: list[list[Cell]] = []
    for case in cases:
        cor = [row["restitution"] for row in case.curve.rows]
        resolved = int(sum(row["resolved"] for row in case.curve.rows))
        rows.append(
            [case.name, *case.swept.values(), case.status, min(cor, default=None),
             max(cor, default=None), f"{resolved} of {len(cor)}", case.reason]
        )  # fmt: skip
    columns = ["case", *swept, "status", "least COR", "largest COR", "depths resolved", "reason"]
    return Table("Cases", columns, rows)
