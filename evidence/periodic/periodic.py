"""Areas of periodic contacts beside closed forms and theories, for docs/periodic.md.

With names of surfaces (narrow, broad, jagged, challenge-2048, …) it computes areas, which are kept
in periodic.csv; without, it draws docs/images/periodic.png and prints the tables. `challenge-2048`
and `challenge-4096` have the spectrum of the contact-mechanics challenge. The larger one takes 5
minutes and 2 GB per pressure.
"""

from __future__ import annotations

import csv
import math
import sys
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from restitution import Body, Contact, Grid, Pair, Surface, generate_surface, solve_at_pressure
from restitution.theory import Persson

HERE = Path(__file__).parent
WALL = Body(math.inf, 210e9, 0.25)
FLAT = Pair(WALL, WALL)
E_STAR = FLAT.contact_modulus
PERIOD = 100e-6
# Nodes, Hurst exponent, roll-off and shortest wave (fractions of the period).
SURFACES = {
    "narrow": (256, 0.8, 1 / 8, 1 / 32),
    "broad": (1024, 0.8, 1 / 8, 1 / 128),
    "jagged": (1024, 0.3, 1 / 8, 1 / 128),
    "challenge-2048": (2048, 0.8, 1 / 5, 1 / 500),
    "challenge-4096": (4096, 0.8, 1 / 5, 1 / 1000),
}
PRESSURES = (0.003, 0.01, 0.03, 0.06, 0.1, 0.15)
CHALLENGE = (0.0025, 0.005, 0.01, 0.02, 0.04)  # the challenge is at 0.01
COLUMNS = ("surface", "pressure", "counted_area", "area", "gap_over_rms", "convolutions")


def rms_slope(height: np.ndarray, spacing: float) -> float:
    """Rms slope of a periodic surface, from its spectrum."""
    qx, qy = (2 * np.pi * np.fft.fftfreq(n, spacing) for n in height.shape)
    power = np.abs(np.fft.fft2(height)) ** 2
    return math.sqrt(float(((qx[:, None] ** 2 + qy**2) * power).sum())) / height.size


def compute(name: str) -> None:
    """Add the areas of the surface `name` to the table."""
    n, hurst, rolloff, shortest = SURFACES[name]
    grid = Grid(n, PERIOD / n)
    surface = generate_surface(
        grid,
        kind="self-affine",
        rms=0.5e-6,
        hurst=hurst,
        rolloff=rolloff * PERIOD,
        shortest=shortest * PERIOD,
        seed=1,
    )
    slope = rms_slope(surface.height, max(grid.spacing))
    contact = Contact(FLAT, surface, periodic=True)
    for pressure in CHALLENGE if name.startswith("challenge") else PRESSURES:
        state = solve_at_pressure(contact, pressure * E_STAR * slope)
        row = (
            name,
            pressure,
            round(state.relative_area, 5),
            round(state.corrected_area / PERIOD**2, 5),
            round(state.mean_gap / surface.height.std(), 4),
            state.convolutions,
        )
        with open(HERE / "periodic.csv", "a", newline="") as file:
            csv.writer(file, lineterminator="\n").writerow(row)
        print(*row, flush=True)


def wave(n: int, share: float) -> tuple[float, float]:
    """Relative area, and mean gap over amplitude, of Westergaard's wave at p/p* = `share`."""
    grid, amplitude = Grid((n, 1), PERIOD / n), 0.1e-6
    z = amplitude * np.cos(2 * np.pi * grid.x / PERIOD)
    contact = Contact(FLAT, Surface(z[:, None], grid), periodic=True)
    state = solve_at_pressure(contact, share * math.pi * E_STAR * amplitude / PERIOD)
    return state.relative_area, state.mean_gap / amplitude


def egg_box(n: int, share: float) -> float:
    """Relative area of two crossed waves at p/p* = `share`."""
    grid, amplitude = Grid(n, PERIOD / n), 0.1e-6
    along = np.cos(2 * np.pi * grid.x / PERIOD)
    contact = Contact(FLAT, Surface(amplitude * np.outer(along, along), grid), periodic=True)
    full = math.sqrt(2) * math.pi * E_STAR * amplitude / PERIOD
    return solve_at_pressure(contact, share * full).corrected_area / PERIOD**2


def convergence() -> None:
    """Print the error of the mean gap of Westergaard's wave against the number of nodes."""
    share = 0.3
    exact = 1 - share + share * math.log(share)
    for n in (32, 64, 128, 256, 512):
        errors = [abs(wave(m, share)[1] / exact - 1) for m in range(n, n + 16, 2)]
        print(f"{n} nodes: mean gap within {np.mean(errors):.1e}")


def draw(rows: list[dict[str, str]]) -> None:
    """Draw areas of waves beside closed forms, and of rough surfaces beside theories."""
    figure = Figure(figsize=(10, 4.2), layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2)
    P = np.linspace(0.001, 1, 300)
    shares = (0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 0.95)
    left.plot(P, 2 / np.pi * np.arcsin(np.sqrt(P)), "C0-", lw=1, label="Westergaard (1939)")
    left.plot(shares, [wave(512, share)[0] for share in shares], "C0o", ms=4, label="one wave")
    low, high = P[P < 0.25], P[P > 0.75]
    jgh = "Johnson et al. (1985), both limits"
    left.plot(low, np.pi * (3 * low / (8 * np.pi)) ** (2 / 3), "C1--", lw=1, label=jgh)
    left.plot(high, 1 - 3 / (2 * np.pi) * (1 - high), "C1--", lw=1)
    left.plot(shares, [egg_box(256, s) for s in shares], "C1s", ms=4, label="two crossed waves")
    left.set(xlabel="nominal pressure over that of full contact", ylabel="relative contact area")
    left.legend()
    for k, (name, symbol) in enumerate(zip(SURFACES, "o^vsD", strict=True)):
        own = [row for row in rows if row["surface"] == name]
        p = np.array([float(row["pressure"]) for row in own])
        kappa = np.array([float(row["area"]) for row in own]) / p
        right.plot(p, kappa, f"C{k}{symbol}-", ms=4, lw=0.8, label=name)
    p = np.geomspace(0.002, 0.2, 100)
    right.plot(p, Persson(1.0, 1.0).relative_area(p) / p, "k--", lw=1, label="Persson (2001)")
    right.axhline(math.sqrt(2 * math.pi), color="k", ls=":", lw=1, label="Bush et al., √(2π)")
    right.set(
        xscale="log", xlabel="p/(E* h′)", ylabel="relative area over p/(E* h′)", ylim=(1.4, 2.9)
    )
    right.legend(ncols=2, fontsize="small")
    figure.savefig(HERE.parents[1] / "docs" / "images" / "periodic.png", dpi=130)


def main() -> None:
    """Compute the surfaces that are named, or draw the figure."""
    for name in sys.argv[1:]:
        compute(name)
    if len(sys.argv) == 1:
        with open(HERE / "periodic.csv", newline="") as file:
            draw(list(csv.DictReader(file)))
        convergence()


if __name__ == "__main__":
    main()
