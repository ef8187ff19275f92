"""Extrapolate the steep waves to vanishing element size.

Reads the convergence cases in data/checks (`cases.py --checks`), and writes data/convergence.csv
and the table in method.md. The file has a row for each mesh, and after the meshes of a depth a row
`extrapolated` with its uncertainty.
"""

from __future__ import annotations

import csv
import itertools
import json
from pathlib import Path

from case_list import convergence_cases, crest_cases

HERE = Path(__file__).parent
TABLE = HERE / "data" / "convergence.csv"
METHOD = HERE / "method.md"
CHECKS = HERE / "data" / "checks"
QUANTITIES = ("restitution", "force_N")
_LEAST = 0.002  # relative error of smooth spheres (method.md)
VALUES = [name + suffix for name in QUANTITIES for suffix in ("", "_uncertainty")]
FIELDS = ("case", "omega", "mesh", "element_size_m", "elements", *VALUES)


def extrapolated(values: list[float]) -> tuple[float, float]:
    """Return the limit of values on meshes with half as large elements each, and its uncertainty.

    Where the values converge, the error is assumed of first order in the element size, as that of
    the contact edge is (Richardson): the limit is the last value plus the last change, and the last
    change is its uncertainty. Otherwise the limit is the last value, and the uncertainty is the
    range of all values. The uncertainty is at least that of smooth spheres.
    """
    least = _LEAST * abs(values[-1])
    changes = [b - a for a, b in itertools.pairwise(values)]
    last = changes[-1]
    if len(changes) == 1 or (last * changes[-2] > 0 and abs(last) < abs(changes[-2])):
        return values[-1] + last, max(abs(last), least)
    return values[-1], max(max(values) - min(values), least)


def meshes(kind: str, position: int) -> list[dict]:
    """Rows of the meshes of one kind at one depth, from coarse to fine; only those computed."""
    found = []
    for factor in (1, 2, 4):
        make = crest_cases if kind == "crests" else convergence_cases
        case = make(factor)[position]
        file = CHECKS / f"{case.name}.json"
        if not file.is_file():
            break
        result = json.loads(file.read_text())
        (summary,), (mesh,) = result["summary"], result["mesh"].values()
        found.append(
            {
                "case": case.name.partition("_omega")[0],
                "omega": summary["omega"],
                "mesh": f"{kind}_{factor}",
                "element_size_m": mesh["element_size_m"],
                "elements": mesh["elements"],
                **{name: summary[name] for name in QUANTITIES},
            }
        )
    return found


def table() -> list[dict]:
    """All meshes of all depths, and the extrapolation of the series with the smallest elements."""
    rows = []
    for position in range(len(convergence_cases(1))):
        series = [meshes(kind, position) for kind in ("refined", "crests")]
        for each in series:
            rows += each
        best = min(
            (each for each in series if len(each) > 1),
            key=lambda each: each[-1]["element_size_m"],
            default=None,
        )
        if best is None:
            continue
        limit = {**best[-1], "mesh": "extrapolated", "element_size_m": 0, "elements": ""}
        for name in QUANTITIES:
            value, uncertainty = extrapolated([row[name] for row in best])
            limit[name], limit[f"{name}_uncertainty"] = f"{value:.5g}", f"{uncertainty:.2g}"
        rows.append(limit)
    return rows


def markdown(rows: list[dict]) -> str:
    """COR of all meshes, a line for each depth."""
    names = [f"{kind}_{factor}" for kind in ("refined", "crests") for factor in (1, 2, 4)]
    lines = ["| case | ω | " + " | ".join(f"`{name}`" for name in names) + " | limit |"]
    lines.append("|---" * (len(names) + 3) + "|")
    for key in dict.fromkeys((row["case"], row["omega"]) for row in rows):
        of = {row["mesh"]: row for row in rows if (row["case"], row["omega"]) == key}
        cells = [f"{of[name]['restitution']:.4f}" if name in of else "" for name in names]
        limit = of.get("extrapolated")
        if limit is not None:
            value, uncertainty = (float(limit[f"restitution{end}"]) for end in ("", "_uncertainty"))
            cells.append(f"{value:.4f} ± {uncertainty:.4f}")
            lines.append(f"| `{key[0]}` | {key[1]:g} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main() -> None:
    """Write the file and the table."""
    rows = table()
    with open(TABLE, "w", newline="", encoding="utf-8") as file:
        out = csv.DictWriter(file, FIELDS, lineterminator="\n")
        out.writeheader()
        out.writerows(rows)
    start, end = "<!-- convergence -->\n", "<!-- end of convergence -->"
    before, _, rest = METHOD.read_text(encoding="utf-8").partition(start)
    _, _, after = rest.partition(end)
    METHOD.write_text(f"{before}{start}\n{markdown(rows)}\n\n{end}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
