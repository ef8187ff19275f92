"""The figure of theories beside one another, and beside a law."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from restitution.case.case import Case
from restitution.laws.closed_forms import FORMS
from restitution.laws.law import Law
from restitution.laws.theories import COMPUTED, Theory, marks, theories
from restitution.reports.figures import plain, write_figure

Array = NDArray[np.float64]

_FINE = 600  # points of a line in the figure


def write_theory_figure(
    case: Case, velocities: Array, found: list[Theory], out: Path, law: Law | None = None
) -> Path:
    """Draw `theory.png` into the folder `out`; return its path. Raises `OutputError`."""
    write_figure(out / "theory.png", theory_figure(case, velocities, found, law))
    return out / "theory.png"


# Colour, dashes and width of each line. Lines that often coincide at e = 1 differ in width.
_LINES: dict[str, tuple[str, str | tuple[int, tuple[int, ...]], float]] = {
    "hertz": ("0.75", "-", 5.0),
    "sticking": ("#f0a830", "-", 3.2),
    "thornton-ning": ("black", "-", 1.4),
    "johnson": ("#d62728", "-", 1.4),
    "mdr": ("#000080", (0, (5, 1, 1, 1)), 1.4),
    "constant": ("#e3d5ae", "-", 3.2),
    "walton-braun": ("#8c564b", (0, (4, 2)), 1.2),
    "luding": ("#17becf", (0, (3, 1, 1, 1, 1, 1)), 1.4),
    "eepa": ("#808000", (0, (2, 3)), 1.4),
    "brilliantov": ("#ff5500", (0, (7, 1, 2, 1)), 1.2),
}


def theory_figure(
    case: Case, velocities: Array, found: list[Theory], law: Law | None = None
) -> Figure:
    """COR against velocity: one line for each theory, the computed points as markers."""
    drawing = Figure(figsize=(8.6, 5.0), layout="constrained")
    axes = drawing.add_subplot()
    low, high = float(velocities[0]), float(velocities[-1])
    lines, many = _fine(case, velocities, found), velocities.size > 1
    if law is not None:
        _draw_points(axes, law)
    for each, (V, e) in zip(found, lines, strict=True):
        if each.name != COMPUTED and np.isfinite(e).any():
            colour, dashes, width = _LINES[each.name]
            axes.plot(V, e, color=colour, ls=dashes, lw=width, marker="" if many else "o",
                      label=each.name + " (fit)" * (each.name not in FORMS))  # fmt: skip
    axes.set(xscale="log", ylim=(-0.02, 1.05), xlabel="impact velocity (m/s)",
             ylabel="coefficient of restitution", title=plain(case.title))  # fmt: skip
    _draw_marks(axes, marks(case), low, high)
    axes.grid(color="0.92", lw=0.6)
    axes.set_axisbelow(True)
    handles, labels = axes.get_legend_handles_labels()
    own = [k for k in np.argsort(labels).tolist() if labels[k].startswith(COMPUTED)]
    order = own + [k for k in range(len(labels)) if k not in own]
    axes.legend(
        [handles[k] for k in order], [labels[k] for k in order], fontsize="small",
        loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, handlelength=3.2,
        title="smooth bodies" if law is None else "smooth bodies, and fits", alignment="left",
    )  # fmt: skip
    return drawing


def _fine(case: Case, velocities: Array, found: list[Theory]) -> list[tuple[Array, Array]]:
    """Velocity and COR of each line: closed forms at many velocities, others at the given ones."""
    if velocities.size == 1:
        return [(velocities, each.restitution) for each in found]
    V = np.geomspace(velocities[0], velocities[-1], _FINE)
    closed = {each.name: each.restitution for each in theories(case, V)}
    return [
        (V, closed[each.name]) if each.name in closed else (velocities, each.restitution)
        for each in found
    ]


def _draw_points(axes: Axes, law: Law) -> None:
    V, e, error = (law.column(name) for name in ("velocity", "restitution", "error"))
    axes.errorbar(V, e, yerr=error, fmt="o", ms=4.5, color="C0", zorder=5, label=COMPUTED)
    unresolved = ~law.column("resolved").astype(bool)
    if unresolved.any():
        axes.plot(V[unresolved], e[unresolved], "o", ms=4.5, mfc="white", mec="C0", ls="none",
                  zorder=6, label=f"{COMPUTED}, not resolved")  # fmt: skip


def _draw_marks(axes: Axes, velocities: Mapping[str, float], low: float, high: float) -> None:
    """Vertical lines with labels at the foot: left of the lower one, right of the higher one."""
    order = sorted(velocities, key=velocities.__getitem__)
    for name, V in velocities.items():
        if not low <= V <= high:
            continue
        axes.axvline(V, color="0.45", lw=0.9, ls=":", zorder=0)
        right = name == order[-1]
        axes.annotate(
            f"${name[0]}_{name[-1]}$", (V, 0.03), xytext=(4 if right else -4, 0),
            textcoords="offset points", ha="left" if right else "right", color="0.3", zorder=7,
            bbox={"fc": "white", "ec": "none", "pad": 0.8, "alpha": 0.8},
        )  # fmt: skip
