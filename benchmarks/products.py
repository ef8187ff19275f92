"""What parts of the minimiser save: products and time of many contacts, with and without each.

A part is taken out by changing the source of the function that it is in. Writes
docs/benchmarks/products.md; `--seeds 1` is quicker.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from unittest import mock

from scaling import PAIR, forget, indentation, surface_of
from unit import machine, today
from variants import changed

from restitution import Contact, Grid, generate_surface, solve
from restitution.contact import equilibrium
from restitution.errors import NotConvergedError
from restitution.numerics import nesting
from restitution.numerics.convolution import FreeConvolution
from restitution.numerics.minimise import minimise_quadratic
from restitution.numerics.nesting import _first_guess, _with_less_mean, minimise_nested

OUT = Path(__file__).parents[1] / "docs" / "benchmarks" / "products.md"

REPORT = """\
# What the parts of the minimiser save

{date}, {machine}. Written by `make bench`.

R* = 250 µm, E* = 112 GPa, δ = a²/R*. Products are counted by their nodes, those of coarser grids,
too. Ratios are without the part over with it, of each contact where both converge: the mean, the
smallest and the largest, and how many are 1.2 or more. "most" is the most products on the finest
grid that a contact takes, without the part and with it. "time" is that of all of them together,
from empty caches, in one turn, and good to a tenth; [tricks.md](tricks.md) has medians of some.

{minimiser} contacts on 256² nodes of 0.25 µm: Gaussian roughness of Rq = 0.02, 0.1 and 0.3 µm, and
self-affine of 0.1 µm (H = 0.5 and 0.8, 1 to 10 µm); elastic, p ≤ 2 GPa and p ≤ 750 MPa; a = 6 and
15 µm; {seeds} of each:

{parts}

{window} contacts on nodes of 0.125 µm, 256² (a = 4 and 8 µm) and 512² (a = 8, 14 and 20 µm):
Gaussian (Rq = 0.1 and 0.3 µm), exponential (0.1 µm) and self-affine (0.1 µm, H = 0.8, 0.5 to
10 µm); elastic and p ≤ 750 MPa; {seeds} of each. In a window around the pressure of the guess
alone, some are solved twice:

{windows}

Both kinds again, and {large} contacts of [scaling.md](scaling.md) that fill 1024² to 4096² nodes,
elastic and p ≤ 750 MPa ("these"). Plastic contacts have no such mean, elastic ones no such jumps:

{guesses}
"""

STEADY = [("length = length * stretch", "pass"), ("kept, 0.0) * stretch", "kept, 0.0)")]
FIRST = ("_FIRST * stretch", "stretch")
# The iteration of Polonsky and Keer (1999): a best step among the free nodes, then projected; the
# direction is forgotten when nodes come in.
PROJECTED_AFTER = [
    FIRST,
    STEADY[0],
    ("kept, 0.0) * stretch", "kept, 0.0) * (iteration > 1 and not coming)"),
    (
        "slope, cut = passes.direct(d, kept, z, down, p, g, r, lower, upper)",
        "d *= kept; d -= z; d *= r != 0; slope, cut = passes.products(d, r, r)[0], False",
    ),
    ("if some(taken > 1):", "if False:"),
    (
        "residual = passes.advance(p, g, d, Kd, taken, lower, upper, r)",
        "p += taken * d; np.clip(p, lower, upper, out=p); g = quick(p, out=g); "
        "residual = passes.downhill(p, g, b, lower, upper, r); "
        "coming = np.any((r != 0) & ((p <= lower) | (p >= upper)))",
    ),
]
WHOLE = ("step > _NEARLY", "step > 1")
FLETCHER_REEVES = ("np.maximum(overlap, 0.0)", "overlap")
WITHIN = ("np.maximum(step, 0.0))\n", "np.clip(step, 0.0, 1.0))\n")
# What takes the place of which parts of the minimiser.
PARTS = {
    "steps projected onto the bounds before the product": PROJECTED_AFTER,
    "trial steps shorter from the first": [FIRST],
    "trial steps as long as the last ones suggest": STEADY,
    "all that was projected taken, where most of it is best": [WHOLE],
    "steps beyond what was projected": [WITHIN],
    "the last four: how long steps are": [FIRST, *STEADY, WHOLE, WITHIN],
    "no more kept of a direction than Fletcher and Reeves would": [FLETCHER_REEVES],
}


# The whole residual through the preconditioner, whatever becomes of its mean.
ALL_OF_THE_MEAN = ("if every(nodes <= 0.5 * touching):", "if True:")
# What lies between the nodes of a coarser grid, interpolated wherever nodes yield.
NO_JUMPS = ("free <= _NEARLY_NONE * touching", "free < 0")
# The window around the pressure of the guess, whatever the guess leaves closed.
BY_PRESSURE = [("(p > 0) | (Kp < b)", "p > 0"), ("Kp = whole.quick(p)", "pass")]
HEAD = """\
| without | products | 1.2 or more | most | time | contacts that do not converge |
|---|---|---|---|---|---|
"""


def of_the_minimiser(seeds: int) -> list[tuple[Contact, float]]:
    """Contacts and indentations (m)."""
    kinds = [gaussian(0.02e-6, 1e-6), gaussian(0.1e-6, 2e-6), gaussian(0.3e-6, 1e-6)]
    kinds += [self_affine(0.5, 1e-6), self_affine(0.8, 1e-6)]
    return contacts(256, 0.25e-6, kinds, (math.inf, 2e9, 750e6), (6e-6, 15e-6), seeds)


def of_the_window(seeds: int) -> list[tuple[Contact, float]]:
    """Contacts and indentations (m)."""
    kinds = [gaussian(0.1e-6, 1e-6), gaussian(0.3e-6, 2e-6), self_affine(0.8, 0.5e-6)]
    kinds += [{"kind": "exponential", "rms": 0.1e-6, "correlation_length": 2e-6}]
    limits = math.inf, 750e6
    small = contacts(256, 0.125e-6, kinds, limits, (4e-6, 8e-6), seeds)
    return small + contacts(512, 0.125e-6, kinds, limits, (8e-6, 14e-6, 20e-6), seeds)


def of_large_grids() -> list[tuple[Contact, float]]:
    """Contacts and indentations (m)."""
    delta = indentation("filling")
    return [
        (Contact(PAIR, surface, p_y), delta)
        for surface in map(surface_of, (1024, 2048, 4096))
        for p_y in (math.inf, 750e6)
    ]


def gaussian(rms: float, length: float) -> dict:
    """Gaussian roughness of that correlation length (m)."""
    return {"kind": "gaussian", "rms": rms, "correlation_length": length}


def self_affine(hurst: float, shortest: float) -> dict:
    """Self-affine roughness down to that wavelength (m)."""
    return {"kind": "self-affine", "rms": 0.1e-6, "hurst": hurst, "rolloff": 10e-6,
            "shortest": shortest}  # fmt: skip


def contacts(
    n: int, spacing: float, kinds: list[dict], limits: tuple, radii: tuple, seeds: int
) -> list[tuple[Contact, float]]:
    """All combinations, on n × n nodes."""
    grid = Grid((n, n), (spacing, spacing))
    return [
        (Contact(PAIR, surface, p_y), a * a / PAIR.radius)
        for seed in range(seeds)
        for surface in (generate_surface(grid, seed=seed, **kind) for kind in kinds)
        for p_y in limits
        for a in radii
    ]


@dataclass
class Cost:
    """Of a solve: nodes that went through products, products on the finest grid, and seconds.

    Infinite where it does not converge.
    """

    nodes: float = math.inf
    products: float = math.inf
    seconds: float = math.inf


def solved(contact: Contact, delta: float) -> Cost:
    """What a solve costs, from empty caches."""
    nodes = 0
    convolve = FreeConvolution._convolve

    def counting(self, p, *others):
        nonlocal nodes
        nodes += p.size
        return convolve(self, p, *others)

    forget()
    _ = contact.gap  # which a contact keeps: else the first solve of it would take longer
    began = time.perf_counter()
    with mock.patch.object(FreeConvolution, "_convolve", counting):
        try:
            state = solve(contact, delta)
        except NotConvergedError:
            return Cost()
    return Cost(nodes, state.convolutions, time.perf_counter() - began)


def row(name: str, module: ModuleType, function: Callable, part: list, cases: list) -> str:
    """What a part of a function saves, which solves find in `module`; a row of Markdown."""
    other = changed(function, *part)
    without, with_it = [], []
    solved(*cases[-1])  # memory is slow where it is touched for the first time
    for case in cases:
        with_it.append(solved(*case))
        with mock.patch.object(module, function.__name__, other):
            without.append(solved(*case))
    pairs = [pair for pair in zip(without, with_it, strict=True) if math.isfinite(pair[0].nodes)]
    products = [a.nodes / b.nodes for a, b in pairs]
    most = [max(cost.products for cost in costs) for costs in zip(*pairs, strict=True)]
    taken = [sum(cost.seconds for cost in costs) for costs in zip(*pairs, strict=True)]
    cells = (
        f"| {name} | {statistics.mean(products):.2f} ({min(products):.2f} to {max(products):.2f}) "
        f"| {sum(ratio >= 1.2 for ratio in products)} | {most[0]}, {most[1]} "
        f"| {taken[0] / taken[1]:.2f} | {len(cases) - len(pairs)} |"
    )
    print(cells, flush=True)
    return cells


def main() -> None:
    """Take out every part of every solve, and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--out", type=Path, default=OUT)
    options = parser.parse_args()
    where = machine()
    minimiser, window = of_the_minimiser(options.seeds), of_the_window(options.seeds)
    large = of_large_grids()
    parts = [row(name, nesting, minimise_quadratic, part, minimiser)
             for name, part in PARTS.items()]  # fmt: skip
    name = "a window as wide as what the guess leaves closed"
    windows = row(name, equilibrium, minimise_nested, BY_PRESSURE, window)
    guesses = [
        row(f"{name}: {which}", nesting, function, [part], cases)
        for name, function, part in (
            ("less of the mean where its inverse is too much", _with_less_mean, ALL_OF_THE_MEAN),
            ("jumps of the pressure between the nodes of a guess", _first_guess, NO_JUMPS),
        )
        for which, cases in (("the first", minimiser), ("the second", window), ("these", large))
    ]
    options.out.write_text(
        REPORT.format(date=today(), machine=where, seeds=options.seeds, minimiser=len(minimiser),
                      window=len(window), large=len(large), parts=HEAD + "\n".join(parts),
                      windows=HEAD + windows, guesses=HEAD + "\n".join(guesses))
    )  # fmt: skip


if __name__ == "__main__":
    main()
