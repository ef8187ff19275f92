"""What the parts of the minimiser save: products and time of many contacts, with and without each.

A part is taken out by changing the source of the minimiser. Writes docs/benchmarks/products.md;
`--seeds 1` is quicker.
"""

from __future__ import annotations

import argparse
import math
import statistics
from pathlib import Path
from unittest import mock

from scaling import PAIR
from unit import machine, seconds, today
from variants import changed

from restitution import Contact, Grid, generate_surface, solve
from restitution.errors import NotConvergedError
from restitution.numerics import nesting
from restitution.numerics.convolution import FreeConvolution
from restitution.numerics.minimise import minimise_quadratic

OUT = Path(__file__).parents[1] / "docs" / "benchmarks" / "products.md"

REPORT = """\
# What the parts of the minimiser save

{date}, {machine}. Written by `make bench`.

{contacts} contacts on 256² nodes of 0.25 µm, R* = 250 µm, E* = 112 GPa: Gaussian roughness of Rq =
0.02, 0.1 and 0.3 µm, and self-affine of 0.1 µm (H = 0.5 and 0.8, 1 to 10 µm); elastic, p ≤ 2 GPa
and p ≤ 750 MPa; δ = a²/R* with a = 6 and 15 µm; {seeds} of each. Products are counted by their
nodes, those of coarser grids, too. Ratios are without the part over with it, of each contact where
both converge: the mean, and the smallest and the largest. "time" is that of all of them together.

| without | products | time | contacts that do not converge |
|---|---|---|---|
{table}
"""

STEADY = [("length = length * stretch", "pass"), ("kept, 0.0) * stretch", "kept, 0.0)")]
# The iteration of Polonsky and Keer (1999): a best step among the free nodes, then projected; the
# direction is forgotten when nodes come in.
PROJECTED_AFTER = [
    STEADY[0],
    ("kept, 0.0) * stretch", "kept, 0.0) * (iteration > 1 and not coming)"),
    (
        "slope, cut = passes.direct(d, kept, z, length, p, g, r, lower, upper)",
        "d *= kept; d -= z; d *= r != 0; slope, cut = passes.dot(r, d), False",
    ),
    ("if some(taken > 1):", "if False:"),
    (
        "residual = passes.advance(p, g, d, Kd, taken, lower, upper, r)",
        "p += taken * d; np.clip(p, lower, upper, out=p); g = _gradient(quick, p, b, out=g); "
        "residual = passes.downhill(p, g, lower, upper, r); "
        "coming = np.any((r != 0) & ((p <= lower) | (p >= upper)))",
    ),
]
WHOLE = ("step > _NEARLY", "step > 1")
WITHIN = ("np.maximum(step, 0.0))\n", "np.clip(step, 0.0, 1.0))\n")
# What takes the place of which parts of the minimiser.
PARTS = {
    "steps projected onto the bounds before the product": PROJECTED_AFTER,
    "trial steps as long as the last ones suggest": STEADY,
    "all that was projected taken, where most of it is best": [WHOLE],
    "steps beyond what was projected": [WITHIN],
    "the last three": [*STEADY, WHOLE, WITHIN],
    "no more kept of a direction than Fletcher and Reeves would": [
        ("np.maximum(overlap, 0.0)", "overlap")
    ],
}


def contacts(seeds: int) -> list[tuple[Contact, float]]:
    """Contacts and indentations."""
    grid = Grid((256, 256), (0.25e-6, 0.25e-6))
    kinds = [{"kind": "gaussian", "rms": rms, "correlation_length": length}
             for rms, length in ((0.02e-6, 1e-6), (0.1e-6, 2e-6), (0.3e-6, 1e-6))]  # fmt: skip
    kinds += [{"kind": "self-affine", "rms": 0.1e-6, "hurst": hurst, "rolloff": 10e-6,
               "shortest": 1e-6} for hurst in (0.5, 0.8)]  # fmt: skip
    return [
        (Contact(PAIR, surface, p_y), a * a / PAIR.radius)
        for seed in range(seeds)
        for surface in (generate_surface(grid, seed=seed, **kind) for kind in kinds)
        for p_y in (math.inf, 2e9, 750e6)
        for a in (6e-6, 15e-6)
    ]


def solved(contact: Contact, indentation: float) -> tuple[float, float]:
    """Nodes that went through products, and seconds; infinite where the solve does not converge."""
    nodes = 0
    convolve = FreeConvolution._convolve

    def counting(self, p, *others):
        nonlocal nodes
        nodes += p.size
        return convolve(self, p, *others)

    with mock.patch.object(FreeConvolution, "_convolve", counting):
        try:
            taken = seconds(lambda: solve(contact, indentation))
        except NotConvergedError:
            return math.inf, math.inf
    return nodes, taken


def row(part: list[tuple[str, str]], cases: list) -> str:
    """What a part saves, as cells of Markdown."""
    other = changed(minimise_quadratic, *part)
    without, with_it = [], []
    for case in cases:
        with_it.append(solved(*case))
        with mock.patch.object(nesting, "minimise_quadratic", other):
            without.append(solved(*case))
    pairs = [pair for pair in zip(without, with_it, strict=True) if math.isfinite(pair[0][0])]
    products = [a[0] / b[0] for a, b in pairs]
    time = sum(a[1] for a, _ in pairs) / sum(b[1] for _, b in pairs)
    return (
        f"{statistics.mean(products):.2f} ({min(products):.2f} to {max(products):.2f}) "
        f"| {time:.2f} | {len(cases) - len(pairs)}"
    )


def main() -> None:
    """Take out every part of every solve, and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--out", type=Path, default=OUT)
    options = parser.parse_args()
    where, cases = machine(), contacts(options.seeds)
    rows = []
    for name, part in PARTS.items():
        rows.append(f"| {name} | {row(part, cases)} |")
        print(rows[-1], flush=True)
    options.out.write_text(
        REPORT.format(date=today(), machine=where, contacts=len(cases), seeds=options.seeds,
                      table="\n".join(rows))
    )  # fmt: skip


if __name__ == "__main__":
    main()
