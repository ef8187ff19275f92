r"""Impacts without adhesion: waves in patches, or left out, beside cells 8 times finer.

    python -m evidence.two_scales.dry --topographies ../shared/topographies

appends to dry.csv a row for each COR of 51 random cases (scan, twin and self-affine surfaces;
constant and growing bound). Cases that are in it are not solved again. The constants of the law
were chosen on the seeds 300 to 335, those of its error on the seeds of parts.py. Cases from 500 on
were drawn after that.
"""

from __future__ import annotations

import math
import tempfile
import time
from pathlib import Path

import numpy as np

from evidence.two_scales.table import Table, options
from restitution.case.case_file import parse_case
from restitution.numerics.grid import Grid
from restitution.results.writer import ResultsFolder
from restitution.runs.run import run_case
from restitution.surfaces import generate_surface

FINER = 8
FIRST = 700
CASES = (*range(24), *range(500, 527))
SCANS = (
    # file, edge in um, detrend, what the file does not say, Rq in nm
    ("di-3.di", 10, "tilt", "", 230),
    ("mi-1.mi", 20, "tilt", "", 33),
    ("matrix-3.txt", 10, "tilt", 'size = "10 um"\n', 35),
)
KINDS = ("scan", "twin", "self-affine")
COLUMNS = (
    "case",
    "kind",
    "bound",
    "radius_over_split",
    "velocity",
    "direct",
    "patch",
    "patch_error",
    "patch_grid_error",
    "omit",
    "omit_error",
    "omit_grid_error",
)
TABLE = Table(__file__, COLUMNS)


def draw(seed: int, scans: Path, folder: Path) -> tuple[str, str, float]:
    """Kind, text and spacing (m) of a case on coarse cells."""
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % 3]
    E = 10 ** rng.uniform(10.7, 11.4)
    E_star = E / (2 * (1 - 0.3**2))
    if kind == "self-affine":
        n, h = 512, 10 ** rng.uniform(-7.5, -6.7)
        slope, hurst = 10 ** rng.uniform(-1.5, -0.7), rng.uniform(0.6, 0.9)
        grid = Grid((n, n), (h, h))
        waves = {"hurst": hurst, "rolloff": n * h * rng.uniform(0.05, 0.3), "shortest": 4 * h}
        rough = generate_surface(grid, kind="self-affine", rms=1e-8, seed=seed, **waves)
        gx = np.diff(rough.height, axis=0) / h
        height = rough.height * slope / (math.sqrt(2) * gx.std())
        np.save(folder / f"{seed}.npy", height)
        rms = float(height.std())
        file, edge, detrend = (folder / f"{seed}.npy").as_posix(), n * h, "none"
        more = f'size = "{1e6 * edge * (1 + 1e-9):.13g} um"\nheight_unit = "m"\n'
        nodes = n // FINER
    else:
        name, wide, detrend, more, rq = SCANS[rng.integers(len(SCANS))]
        file, edge, nodes = (scans / name).as_posix(), 1e-6 * wide, 256 // FINER
        rms = 1e-9 * rq
        if kind == "twin":
            nodes *= 2
            more += f'extend = "twin"\nseed = {rng.integers(10**6)}\n'
    spacing = edge / (256 if kind != "self-affine" else 512) * FINER
    split, half = 2 * spacing, 0.5 * nodes * spacing
    R_star = (0.35 * half) ** 2 / (rms * rng.uniform(1, 4))
    hard = E_star * 10 ** rng.uniform(-2.2, -1.5)
    bound = "constant" if rng.random() < 0.5 else "growing"
    yields = (
        f'yield_pressure = "{hard:.6g} Pa"'
        if bound == "constant"
        else f'yield_strength = "{hard / 2.8:.6g} Pa"'
    )
    a = np.geomspace(2 * split, max(0.35 * half, 3 * split), 3)
    mass = 4 / 3 * math.pi * R_star**3 * 5000  # a sphere on a wall
    work = 8 / 15 * E_star * a**5 / R_star**2
    speeds = ", ".join(f'"{v:.6g} m/s"' for v in np.sqrt(2 * work / mass))
    body = f'youngs_modulus = "{E:.6g} Pa"\npoissons_ratio = 0.3\n'
    return (
        kind,
        f'[first]\nradius = "{R_star:.6g} m"\ndensity = "5000 kg/m^3"\n{body}'
        f'[second]\nradius = "flat"\n{body}[interface]\n{yields}\n[roughness]\nkind = "measured"\n'
        f'file = "{file}"\ndetrend = "{detrend}"\n{more}BELOW'
        f'[grid]\nnodes = {nodes}\nspacing = "{spacing:.13g} m"\nREFINE'
        f"[impact]\nvelocity = [{speeds}]\n[unloading]\ncurves = 0\n",
        split,
    )


def run(text: str, folder: Path, *, errors: bool) -> dict[float, object]:
    """Points by velocity."""
    with tempfile.TemporaryDirectory() as temporary:
        out = ResultsFolder(Path(temporary) / "out")
        case = parse_case(text)
        try:
            run_case(case, text, folder, out, errors=errors)
        except Exception as error:
            print("   ", type(error).__name__, str(error)[:120], flush=True)
        return {round(math.log(p.impact_velocity), 3): p for p in out.curve.points}


def rows_of(number: int, scans: Path) -> list[dict[str, object]]:
    with tempfile.TemporaryDirectory() as temporary:
        kind, text, split = draw(FIRST + number, scans, Path(temporary))
        began = time.process_time()
        omit = text.replace("BELOW", 'below_grid = "omit"\n')
        direct = run(
            "total_error = false\n" + omit.replace("REFINE", f"refine = {FINER}\n"),
            Path(temporary),
            errors=True,
        )
        middle = time.process_time()
        patch = run(
            text.replace("BELOW", 'below_grid = "patch"\n').replace("REFINE", "refine = 1\n"),
            Path(temporary),
            errors=True,
        )
        end = time.process_time()
        left = run(omit.replace("REFINE", ""), Path(temporary), errors=True)
    print(
        number,
        kind,
        f"direct {middle - began:.0f} s, patch {end - middle:.0f} s with errors",
        flush=True,
    )
    rows = []
    for key in sorted(direct):
        if key not in patch or key not in left:
            continue
        d, p, o = direct[key], patch[key], left[key]
        rows.append(
            {
                "case": number,
                "kind": kind,
                "bound": "growing" if "yield_strength" in text else "constant",
                "radius_over_split": round(math.sqrt(d.contact_nodes) and radius(d) / split, 2),
                "velocity": f"{d.impact_velocity:.4g}",
                "direct": f"{d.restitution:.4f}",
                "patch": f"{p.restitution:.4f}",
                "patch_error": f"{p.total_error:.4f}",
                "patch_grid_error": f"{p.discretisation_error:.4f}",
                "omit": f"{o.restitution:.4f}",
                "omit_error": f"{o.total_error:.4f}",
                "omit_grid_error": f"{o.discretisation_error:.4f}",
            }
        )
        print("   ", *rows[-1].values(), flush=True)
    return rows


def radius(point: object) -> float:
    """Contact radius (m) of the real contact area."""
    return math.sqrt(point.contact_area / math.pi)


def summary() -> None:
    for words, first, last in (("drawn before", 0, 500), ("drawn after", 500, 1000)):
        print(words, "the constants of the error were chosen:")
        summary_of([row for row in TABLE.rows() if first <= int(row["case"]) < last])


def summary_of(rows: list[dict[str, str]]) -> None:
    number = lambda name: np.array([float(row[name]) for row in rows])  # noqa: E731
    direct, kinds = number("direct"), [row["bound"] for row in rows]
    for way in ("patch", "omit"):
        off, total, grid = (
            np.abs(number(way) - direct),
            number(f"{way}_error"),
            number(f"{way}_grid_error"),
        )
        print(
            f"{way}: |COR - direct| median {np.median(off):.4f}, 90 % {np.quantile(off, 0.9):.4f}; "
            f"within the total error {np.mean(off <= total):.0%}, within the error of the grid "
            f"{np.mean(off <= grid):.0%}; total error {np.nanmedian(total):.4f}, of the grid "
            f"{np.nanmedian(grid):.4f} in the median"
        )
        for bound in ("constant", "growing"):
            held = [off[k] <= total[k] for k in range(len(rows)) if kinds[k] == bound]
            print(f"    {bound} bound: {sum(held)} of {len(held)} within the total error")
    for name in ("error", "grid_error"):
        patch, omit = number(f"patch_{name}"), number(f"omit_{name}")
        print(
            f"ratio of {name}, median: {np.nanmedian(patch / omit):.3f}, "
            f"of the medians: {np.nanmedian(patch) / np.nanmedian(omit):.3f}"
        )


def main() -> None:
    given = options(__doc__)
    if not given.summary:
        done = TABLE.cases()
        for number in CASES:
            if number not in done:
                TABLE.append(rows_of(number, given.topographies))
    summary()


if __name__ == "__main__":
    main()
