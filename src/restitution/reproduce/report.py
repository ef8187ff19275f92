"""Write the page that compares Ghanbarzadeh et al. (2019) with the stored studies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
import xarray as xr

from restitution.pages.methods import methods
from restitution.pages.page import Cell, Drawing, Page, PageTable, write_page
from restitution.plots.figure import (
    DASHED,
    GREY,
    PALETTE,
    SYMBOLS,
    Axis,
    Chart,
    Figure,
    Line,
    Points,
    Series,
)
from restitution.reproduce.claims import (
    CLAIMS,
    E_STAR,
    P_Y,
    SMOOTH,
    Array,
    CaseCurve,
    Judgement,
    R,
    critical_indentations,
    curves,
    rough_and_smooth,
)
from restitution.reproduce.studies import NAMES, Size
from restitution.results.reader import StudyResults
from restitution.theory import JKR, Hertz, ThorntonNing

PAPER = (
    "Ghanbarzadeh, Hassanpour and Neville (2019), Powder Technology 345, 203–212, "
    "doi:10.1016/j.powtec.2018.12.079"
)
_OPEN = (
    ("radius of 500 µm", "of each particle, so that R* = 250 µm", "not stated; may be R*"),
    ("autocorrelation of the surfaces", "Gaussian", "not stated"),
    ("correlation length", "2 µm (10 %)", "not stated"),
    ("yield stress", "largest contact pressure p_y", "called yield stress and yield pressure"),
    (
        "yielding",
        "pressure and surface in equilibrium, except in Figure 6",
        "pressure truncated at the yield pressure",
    ),
    ("detachment", "crack closure", "criterion of Pohrt and Popov (2015)"),
    ("seeds", "1, and several seeds in Figure 11", "not stated"),
    ("smooth sphere of Figures 10 to 12", f"Rq = {SMOOTH} on the same grid", "smooth"),
)


def write_reproduction(out: Path, size: Size) -> tuple[Path, list[Judgement]]:
    stored = {name: StudyResults(out / name) for name in NAMES}
    studies = {name: study.dataset for name, study in stored.items()}
    findings = [claim(studies) for claim in CLAIMS]
    judged = ", ".join(
        f"{sum(f.verdict == v for f in findings)} {v}"
        for v in ("agrees", "agrees in part", "does not agree", "not decided")
    )
    page = Page(
        title="The figures of Ghanbarzadeh, Hassanpour and Neville (2019)",
        intro=[PAPER, f"Size: {size}. Claims: {judged}."],
        warnings=_warnings(size),
        parts=[
            PageTable(
                "Claims",
                ["figure", "verdict", "claim", "result", "number", "depths resolved"],
                [[f.figure, f.verdict, f.claim, f.result, f.number, f.resolved] for f in findings],
            ),
            PageTable("What the paper leaves open", ["input", "here", "in the paper"], _OPEN),
            *_drawings(studies, findings),
            methods(stored["roughness"].run("case-00002").summary),
        ],
    )
    return write_page(out / "report.html", page), findings


def _warnings(size: Size) -> list[str]:
    if size == "quick":
        return [
            "Quick size: fewer depths, fewer surfaces and smaller domains than in the paper; leave "
            "out --quick for the size of the paper."
        ]
    spacing, more = ("0.25 µm", " (--refined halves it)") if size == "paper" else ("0.125 µm", "")
    return [
        f"With a spacing of {spacing}{more}, rough contacts at indentations below some tens of "
        "nanometres have only a few nodes (open markers), so their results depend on the grid."
    ]


def _drawings(studies: dict[str, xr.Dataset], findings: list[Judgement]) -> list[Drawing]:
    def words(figure: str) -> str:
        return " ".join(f"{f.result} ({f.verdict})" for f in findings if f.figure == figure)

    rough, smooth = rough_and_smooth(studies["roughness"])
    return [
        _lines(
            "Figure 5: force on smooth elastic spheres",
            "force (N)",
            words("5"),
            [(c, c.force) for c in curves(studies["hertz"])],
            [("Hertz", Hertz(R, E_STAR).force)],
            scale="log",
        ),
        _lines(
            "Figure 6: force on smooth elastic–plastic spheres",
            "force (N)",
            words("6"),
            [(c, c.force) for c in curves(studies["thornton-ning"])],
            [("Thornton and Ning", ThorntonNing(R, E_STAR, P_Y).loading_force)],
            scale="log",
        ),
        _lines(
            "Figure 7: force on smooth elastic adhesive spheres",
            "force (N)",
            words("7"),
            [(c, c.force) for c in curves(studies["jkr"])],
            [("JKR", JKR(R, E_STAR, 0.09).force)],
        ),
        _lines(
            "Figure 8: smooth adhesive spheres, yield pressure",
            "COR",
            words("8"),
            [(c, c.cor) for c in curves(studies["smooth-yield"])],
        ),
        _lines(
            "Figure 9: smooth adhesive spheres, interface energy",
            "COR",
            words("9"),
            [(c, c.cor) for c in curves(studies["smooth-energy"])],
        ),
        _lines(
            "Figure 10: rough adhesive spheres",
            "COR",
            words("10"),
            [(c, c.cor) for c in (smooth, *rough)],
        ),
        _critical(studies["critical"], words("11")),
        _lines(
            "Figure 12: difference of COR from the smooth sphere",
            "difference (%)",
            words("12"),
            [
                (c, 100 * (smooth.cor - c.cor) / np.where(smooth.cor > 0, smooth.cor, np.nan))
                for c in rough
            ],
        ),
        _lines(
            "Figure 13: rough adhesive sphere, yield pressure",
            "COR",
            words("13"),
            [(c, c.cor) for c in curves(studies["rough-yield"])],
        ),
        _lines(
            "Figure 14: rough adhesive sphere, interface energy",
            "COR",
            words("14"),
            [(c, c.cor) for c in curves(studies["rough-energy"])],
        ),
    ]


def _lines(
    title: str,
    y: str,
    caption: str,
    lines: Sequence[tuple[CaseCurve, Array]],
    laws: Sequence[tuple[str, Callable[[Array], Array]]] = (),
    *,
    scale: Literal["linear", "log"] = "linear",
) -> Drawing:
    """Draw `y` against indentation for several curves; theoretical laws are dashed."""
    rows: list[list[Cell]] = []
    series: list[Series] = []
    for number, (curve, values) in enumerate(lines):
        label = "smooth" if curve.label == SMOOTH else curve.label
        color = PALETTE[number % len(PALETTE)]
        series.append(
            Points(
                1e9 * curve.depth,
                values,
                label,
                color=color,
                symbol=SYMBOLS[number % len(SYMBOLS)],
                joined=True,
                open=~curve.resolved,
            )
        )
        rows += [
            [label, 1e9 * float(d), float(v), "yes" if good else "no"]
            for d, v, good in zip(curve.depth, values, curve.resolved, strict=True)
        ]
    for name, law in laws:
        depth = lines[0][0].depth
        fine = np.geomspace(depth[0], depth[-1], 100)
        series.append(Line(1e9 * fine, law(fine), name, color=GREY, dash=DASHED))
    chart = Chart(Axis("indentation", "nm", "log"), Axis(y, scale=scale), series)
    return Drawing(
        title,
        Figure(title, [chart]),
        f"{title}: {y} against indentation for {len(lines)} cases",
        caption + " Open markers: contacts that the grid does not resolve.",
        PageTable(title, ["case", "indentation (nm)", y, "resolved"], rows),
    )


def _critical(study: xr.Dataset, caption: str) -> Drawing:
    points = [(name, x, 1e6 * y) for name, (x, y) in critical_indentations(study).items()]
    title = "Figure 11: critical indentation"
    series = [Points(np.array([x]), np.array([y]), "one surface", name) for name, x, y in points]
    chart = Chart(Axis("Rq/R"), Axis("i_cr,max", "µm"), series)
    return Drawing(
        title,
        Figure(title, [chart]),
        f"{title} against roughness over radius for {len(points)} surfaces",
        caption + " A surface is not drawn if, at the deepest indentation, its COR differs by more "
        "than 5 % from the smooth sphere's.",
        PageTable(title, ["Rq, seed", "Rq/R", "i_cr,max (µm)"], [list(p) for p in points]),
    )
