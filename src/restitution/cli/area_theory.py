"""`restitution compare-theory` of a periodic contact: contact area beside Persson's theory."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.table import Table

    from restitution.cli.parameters import FigureFormat
    from restitution.compare.area_theory import AreaTheory


def compare_area(given: AreaTheory, source: Path, out: Path | None, figures: FigureFormat) -> None:
    """Print the areas of `given`; write table and figure into `out`, unless it is None.

    `source` is the case file or the results folder.
    """
    from restitution.cli.console import command, print_numbers, say, say_next, say_written
    from restitution.display import quantity
    from restitution.plots.periodic import area_theory_figure
    from restitution.plots.static import write_figure

    written = []
    if out is not None:
        written = [
            given.write(out),
            write_figure(out / "theory", area_theory_figure(given), figures.value),
        ]
    theory, computed = given.theory, bool((given.computed >= 0).any())
    slope, E_star = float(theory.rms_slope), float(theory.contact_modulus)
    say("Relative contact area of the rough surface; a periodic contact has no COR")
    print_numbers(_table(given, computed))
    say(
        "persson: erf(√2 p/(E* h′)), B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840; elastic, "
        "without adhesion"
    )
    say(f"  with: rms slope h′ = {slope:.4g}, E* = {quantity(E_star, 'Pa')}")
    if given.left_out:
        say(f"  the theory leaves out the {given.left_out} of these bodies")
    if computed:
        say(
            "kappa: computed area divided by p/(E* h′); at low pressure 1.60 in Persson's theory, "
            "2.51 in that of Bush, Gibson and Thomas (1975)"
        )
    if out is not None:
        say_written(out, [path.name for path in written])
    if not computed:
        say_next(
            f"{command('run', source, '-o', 'RESULTS')}, then "
            f"{command('compare-theory', 'RESULTS')} (adds computed areas)"
        )


def _table(given: AreaTheory, computed: bool) -> Table:
    from restitution.cli.console import table_of_numbers

    columns = ["pressure (MPa)", "persson (%)"]
    if computed:
        columns += ["computed (%)", "computed/persson", "kappa", "stiffness (MPa/nm)"]
    table = table_of_numbers(*columns)
    for p, area, found, kappa, k in zip(
        given.pressure, given.area, given.computed, given.kappa, given.stiffness, strict=True
    ):
        cells = [f"{1e-6 * p:.4g}", f"{100 * area:.4g}"]
        if computed:
            cells += [f"{100 * found:.4g}", f"{found / area:.3f}", f"{kappa:.3f}"]
            cells.append("-" if math.isnan(k) else f"{1e-15 * k:.4g}")
        table.add_row(*cells)
    return table
