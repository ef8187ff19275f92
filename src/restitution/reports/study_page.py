"""The page of a study: restitution of every case, and what became of each."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import xarray as xr
from plotly.graph_objects import Scatter

from restitution.contact.resolution import NODES_PER_PATCH
from restitution.reports.methods import methods
from restitution.reports.page import Cell, Drawing, Listing, Page, Table, new_plot, write_page

_MOST_LINES = 60  # in one figure: more cannot be told apart


def write_study_page(out: Path) -> Path:
    """Write `report.html` from the `table.csv`, `study.nc` and cases in `out`."""
    with xr.open_dataset(out / "study.nc", engine="netcdf4") as stored:
        study = stored.load()
    with open(out / "table.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    cases: dict[str, list[dict[str, str]]] = {}
    for row in rows:
        cases.setdefault(row["case"], []).append(row)
    swept = list(rows[0])[: list(rows[0]).index("indentation_m")]
    count = {status: sum(of[0]["status"] == status for of in cases.values())
             for status in ("complete", "failed", "missing")}  # fmt: skip
    parts: list[Table | Drawing | Listing] = []
    if count["complete"]:
        parts.append(_restitution(cases, swept, "indentation_m", 1e6, "maximum indentation", "µm"))
        if any(row["impact_velocity_m_per_s"] for row in rows):
            parts.append(
                _restitution(cases, swept, "impact_velocity_m_per_s", 1.0, "impact velocity", "m/s")
            )
    parts += [_cases(cases, swept), Listing("Study file", study.attrs["study"])]
    complete = next((name for name, of in cases.items() if of[0]["status"] == "complete"), None)
    if complete is not None:
        path = out / "cases" / complete / "summary.json"
        parts.append(methods(json.loads(path.read_text(encoding="utf-8"))))
    page = Page(
        title=study.attrs["title"] or "Study",
        intro=[
            f"{len(cases)} cases over {', '.join(swept)}: "
            + ", ".join(f"{number} {status}" for status, number in count.items() if number)
        ],
        warnings=_warnings(rows, count),
        parts=parts,
    )
    write_page(out / "report.html", page)
    return out / "report.html"


def _warnings(rows: list[dict[str, str]], count: dict[str, int]) -> list[str]:
    found = []
    few = sum(row["resolved"] == "false" for row in rows)
    if few:
        found.append(
            f"{few} of {sum(bool(row['restitution']) for row in rows)} depths are not resolved: "
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
    cases: dict[str, list[dict[str, str]]],
    swept: list[str],
    column: str,
    scale: float,
    words: str,
    unit: str,
) -> Drawing:
    plot = new_plot(f"{words} ({unit})", "coefficient of restitution")
    plot.update_xaxes(type="log", exponentformat="power")
    plot.update_yaxes(range=[0, 1.05])
    drawn = {name: of for name, of in cases.items() if of[0]["status"] == "complete"}
    table: list[list[Cell]] = []
    for number, rows in enumerate(drawn.values()):
        rows = [row for row in rows if row[column]]
        x = [scale * float(row[column]) for row in rows]
        y = [float(row["restitution"]) for row in rows]
        name = (
            ", ".join(f"{key.rsplit('.', 1)[-1]} {rows[0][key]}" for key in swept) if rows else ""
        )
        table += [[*(row[key] for key in swept), a, b, row["resolved"]]
                  for row, a, b in zip(rows, x, y, strict=True)]  # fmt: skip
        if number < _MOST_LINES and rows:
            open_or_not = ["circle" if row["resolved"] == "true" else "circle-open" for row in rows]
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


def _escaped(text: str) -> str:
    """A text of the user's where the figures would read markup in it."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _cases(cases: dict[str, list[dict[str, str]]], swept: list[str]) -> Table:
    rows: list[list[Cell]] = []
    for name, of in cases.items():
        cor = np.array([float(row["restitution"]) for row in of if row["restitution"]])
        resolved = sum(row["resolved"] == "true" for row in of)
        rows.append(
            [name, *(of[0][key] for key in swept), of[0]["status"],
             float(cor.min()) if cor.size else None, float(cor.max()) if cor.size else None,
             f"{resolved} of {cor.size}", of[0]["reason"]]
        )  # fmt: skip
    columns = ["case", *swept, "status", "least COR", "largest COR", "depths resolved", "reason"]
    return Table("Cases", columns, rows)
