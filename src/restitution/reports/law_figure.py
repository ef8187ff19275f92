"""The figure of a law."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from restitution.laws.law import Law
from restitution.reports.figures import plain, write_figure

_FINE = 400  # points of the line of the compact fit


def write_law_figure(law: Law, out: Path) -> Path:
    """Draw `law.png` into the folder `out`; return its path. Raises `OutputError`."""
    write_figure(out / "law.png", law_figure(law))
    return out / "law.png"


def law_figure(law: Law) -> Figure:
    """Plot the computed COR with its error, and the fits over the velocities they are fitted to."""
    drawing = Figure(figsize=(7.6, 4.8), layout="constrained")
    axes = drawing.add_subplot()
    V, e = law.column("velocity"), law.column("restitution")
    axes.errorbar(V, e, yerr=law.column("error"), fmt="o", ms=4, color="C0", zorder=3,
                  label="computed")  # fmt: skip
    unresolved = ~law.column("resolved").astype(bool)
    if unresolved.any():
        axes.plot(V[unresolved], e[unresolved], "o", ms=4, mfc="white", mec="C0", zorder=4,
                  ls="none", label="not resolved")  # fmt: skip
    if law.fit is not None:
        fine = np.geomspace(law.fit.lowest, law.fit.highest, _FINE)
        axes.plot(fine, law.fit.restitution(fine), "-", color="C0", lw=1,
                  label=f"compact fit (within {law.fit.worst:.1g})")  # fmt: skip
    for k, other in enumerate(law.laws):
        values = [math.nan if value is None else value for value in other.restitution]
        axes.plot(V, values, "--", lw=1, color=f"C{k + 1}",
                  label=f"{other.name} ({other.worst:.2g})")  # fmt: skip
    axes.set(xscale="log", ylim=(0, 1.05), xlabel="impact velocity (m/s)",
             ylabel="coefficient of restitution", title=plain(law.title))  # fmt: skip
    axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False,
                title="largest difference in brackets")  # fmt: skip
    return drawing
