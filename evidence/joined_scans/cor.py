r"""COR of twins of three virtual scans beside that of the surface that the instruments saw.

    python -m evidence.joined_scans.cor

appends to cor.csv a row for each COR, and to spectrum.csv one for each of 20 random cases. Cases in
the tables are not solved again. The scans differ in place, pixel, edge, smoothing and noise; the
surface is known, and its COR is the mean over 16 of its realisations.
"""

from __future__ import annotations

import csv
import math
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np

import restitution
from restitution.case.case_file import parse_case

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from virtual_instruments import KnownSurface

CASES, FIRST = 20, 5900
NODES, PIXELS, REALISATIONS = 96, 128, 16
LADDER = (36, 6, 1)  # pixels of the scans, in cells
TABLES = tuple(Path(__file__).with_name(name) for name in ("cor.csv", "spectrum.csv"))
COR = ("case", "velocity", "direct", "direct_std", "twin", "total_error", "surface_scatter")
SPECTRUM = (
    "case",
    "hurst",
    "smoothing_pixels",
    "noise_over_rms",
    "largest_off",
    "median_off",
    "within_2_errors",
    "slope_ratio",
    "cut_offs",
)


def draw(seed: int, folder: Path) -> tuple[str, str, KnownSurface, tuple[float, float]]:
    """Case of the twin, case of the known surface, this surface, smoothing and noise."""
    rng = np.random.default_rng(seed)
    h = 10 ** rng.uniform(-7.3, -6.7)
    E = 10 ** rng.uniform(10.7, 11.4)
    E_star = E / (2 * (1 - 0.3**2))
    surface = KnownSurface(
        rms=h * 10 ** rng.uniform(-1.4, -0.6),
        hurst=rng.uniform(0.6, 0.95),
        rolloff=NODES * h / rng.uniform(2, 5),
        shortest=2 * h,
    )
    a = rng.uniform(0.22, 0.3) * NODES * h  # largest contact radius
    R = a**2 / (rng.uniform(2, 8) * surface.rms)  # of the pair; indentation of some rms heights
    p_y = E_star * 10 ** rng.uniform(-2.2, -1.4)
    depth = a**2 / R
    smoothing, noise = rng.uniform(0, 0.8), 10 ** rng.uniform(-4, -1.5)
    names = []
    for k, times in enumerate(LADDER):
        pixel = times * h
        blur = smoothing * pixel if k < 2 else 0.0
        scan = surface.scan(
            PIXELS * pixel,
            PIXELS,
            10 * seed + k,
            smoothing=blur,
            noise=noise * surface.rms if k < 2 else 0.0,
        )
        np.save(folder / f"scan-{k}.npy", scan.height)
        names.append(
            f'[[roughness.scan]]\nfile = "scan-{k}.npy"\nsize = "{1e6 * PIXELS * pixel:.9g} um"\n'
        )
    common = (
        f'first = {{ youngs_modulus = "{E:.6g} Pa", poissons_ratio = 0.3, density = '
        f'"5000 kg/m^3", radius = "{2e6 * R:.6g} um" }}\n'
        f'[interface]\nyield_pressure = "{p_y:.6g} Pa"\nwork_of_adhesion = "0 J/m^2"\n'
        f'[grid]\nnodes = {NODES}\nspacing = "{1e9 * h:.9g} nm"\n'
        f'[indentation]\nfrom = "{0.2e9 * depth:.6g} nm"\nto = "{1e9 * depth:.6g} nm"\n'
        "steps = 3\n[unloading]\ncurves = 0\n[roughness]\n"
    )
    twin = common + f'kind = "joined"\nseed = 1\nbelow_grid = "omit"\n{"".join(names)}'
    shortest = surface.shortest * (1 + 1e-6)  # rounded, it is not below two cells
    known = common + (
        f'kind = "self-affine"\nrms = "{1e9 * surface.rms:.9g} nm"\nhurst = {surface.hurst}\n'
        f'rolloff = "{1e9 * surface.rolloff:.9g} nm"\nshortest = "{1e9 * shortest:.9g} nm"'
        f"\nseed = 100\nrealisations = {REALISATIONS}\n"
    )
    return twin, "total_error = false\n" + known, surface, (smoothing, noise)


def spectrum_row(seed: int, folder: Path, surface: KnownSurface, faults, text: str):
    """How far the joined spectrum is from the known one, from the largest edge on."""
    joined = parse_case(text).roughness[0].spectrum(folder)
    q = joined.wave_number
    inside = (joined.at(q) > 0) & (q < 2 * math.pi / surface.shortest)
    off = np.log(joined.density[inside] / surface.density(q[inside]))
    slope = joined.slope(joined.shortest, joined.longest)
    return (
        seed,
        f"{surface.hurst:.2f}",
        f"{faults[0]:.2f}",
        f"{faults[1]:.1e}",
        f"{np.abs(off).max():.3f}",
        f"{np.median(np.abs(off)):.3f}",
        f"{np.mean(np.abs(off) < 2 * joined.error[inside]):.2f}",
        f"{slope / surface.slope(joined.shortest, joined.longest):.3f}",
        sum("left out" in note for note in joined.notes),
    )


def main() -> None:
    """Add the missing cases to the tables."""
    for table, header in zip(TABLES, (COR, SPECTRUM), strict=True):
        if not table.exists():
            table.write_text(",".join(header) + "\n")
    with TABLES[1].open() as file:
        done = {int(row["case"]) for row in csv.DictReader(file)}
    for seed in (seed for seed in range(FIRST, FIRST + CASES) if seed not in done):
        with tempfile.TemporaryDirectory() as name, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            folder = Path(name)
            twin, known, surface, faults = draw(seed, folder)
            for file, text in (("twin.toml", twin), ("known.toml", known)):
                (folder / file).write_text(text)
            made = restitution.run(folder / "twin.toml").curve.points
            direct = restitution.run(folder / "known.toml").curve.points
            row = spectrum_row(seed, folder, surface, faults, twin)
        with TABLES[0].open("a") as file:
            for point, mean in zip(made, direct, strict=True):
                values = (
                    point.impact_velocity,
                    mean.restitution,
                    mean.restitution_std,
                    point.restitution,
                    point.total_error,
                    point.surface_scatter,
                )
                csv.writer(file).writerow([seed, *(f"{value:.5g}" for value in values)])
        with TABLES[1].open("a") as file:
            csv.writer(file).writerow(row)


if __name__ == "__main__":
    main()
