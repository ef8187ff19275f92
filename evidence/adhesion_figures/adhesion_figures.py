"""Figures 8, 9 and 14 of Ghanbarzadeh et al. (2019), on a grid that resolves the adhesion.

Writes docs/images/adhesion-smooth.png, docs/images/adhesion-rough.png and the table beside it. Some
minutes.
"""

from __future__ import annotations

import numpy as np

from evidence.shared import PAIR, write_image, write_table
from restitution import Contact, Grid, collide, generate_surface, loading_path, smooth
from restitution.contact.checks.resolution import resolves_adhesion
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.plasticity.bound import ConstantBound
from restitution.plots.cor import cor_axis
from restitution.plots.figure import (
    DASHED,
    PALETTE,
    SOLID,
    SYMBOLS,
    Axis,
    Chart,
    Figure,
    Line,
    Points,
)

ENERGIES = (0.01, 0.03, 0.09)
SMOOTH_DEPTHS = np.geomspace(1e-9, 220e-9, 11)
ROUGH_DEPTHS = np.geomspace(5e-9, 500e-9, 8)


def smooth_rows():
    """COR of smooth spheres; the spacing is a fifth of the pull-off radius of each energy."""
    for w in ENERGIES:
        a_c = (9 * np.pi * w * PAIR.radius**2 / (8 * PAIR.contact_modulus)) ** (1 / 3)
        h = a_c / 5
        n = 2 * int(1.25 * np.sqrt(1.5 * PAIR.radius * SMOOTH_DEPTHS[-1]) / h)
        for p_y in (750e6, 1500e6):
            contact = Contact(
                PAIR,
                smooth(Grid((n, n), (h, h))),
                plasticity=ConstantBound(p_y),
                adhesion=JKRLimit(w),
            )
            yield from rows_of("smooth", contact, SMOOTH_DEPTHS)


def rough_rows():
    """COR of one rough surface at the paper's spacing."""
    grid = Grid((256, 256), (0.25e-6, 0.25e-6))
    surface = generate_surface(
        grid, kind="exponential", rms=0.1e-6, correlation_length=2e-6, seed=1
    )
    for w in (0.01, 0.09):
        contact = Contact(PAIR, surface, plasticity=ConstantBound(750e6), adhesion=JKRLimit(w))
        yield from rows_of("rough", contact, ROUGH_DEPTHS)


def rows_of(surface, contact, depths):
    """One row for each depth."""
    for state in loading_path(contact, depths):
        collision = collide(state)
        yield {
            "surface": surface,
            "work_of_adhesion_J_per_m2": contact.adhesion.work_of_adhesion,
            "yield_pressure_Pa": contact.hardness,
            "spacing_m": contact.grid.spacing[0],
            "indentation_m": state.indentation,
            "restitution": collision.restitution,
            "restitution_error": collision.restitution_error,
            "adhesion_resolved": resolves_adhesion(state),
            "impact_velocity_m_per_s": collision.impact_velocity,
        }


def draw(rows, name, title):
    """Draw COR against indentation, with a line for each work of adhesion and yield pressure."""
    keys = sorted({(r["yield_pressure_Pa"], r["work_of_adhesion_J_per_m2"]) for r in rows})
    series = []
    for p_y, w in keys:
        some = [
            r for r in rows if (r["yield_pressure_Pa"], r["work_of_adhesion_J_per_m2"]) == (p_y, w)
        ]
        number = ENERGIES.index(w)
        x = 1e9 * np.array([r["indentation_m"] for r in some])
        y = np.array([r["restitution"] for r in some])
        color, symbol = PALETTE[number], SYMBOLS[number]
        dash = SOLID if p_y < 1e9 else DASHED
        series += [
            Line(x, y, f"p_y = {p_y / 1e6:.0f} MPa", color=color, dash=dash),
            Points(
                x,
                y,
                f"w = {w:g} J/m²",
                color=color,
                symbol=symbol,
                open=np.array([not r["adhesion_resolved"] for r in some]),
            ),
        ]
    chart = Chart(Axis("maximum indentation", "nm", "log"), cor_axis(series), series)
    write_image(name, Figure(title, [chart]))


def main():
    """Compute, store and draw."""
    rows = [*smooth_rows(), *rough_rows()]
    write_table("adhesion_figures/adhesion_figures.csv", rows)
    draw([r for r in rows if r["surface"] == "smooth"], "adhesion-smooth", "Smooth spheres")
    draw(
        [r for r in rows if r["surface"] == "rough"],
        "adhesion-rough",
        "Rough, Rq 0.1 µm; open: adhesion not resolved",
    )


if __name__ == "__main__":
    main()
