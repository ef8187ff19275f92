"""What each trick of the solver is worth: whole solves with it and without, in turns, in one run.

A trick is taken out by patching the package. Writes docs/benchmarks/tricks.md; `--rounds 3` is
quicker.
"""

from __future__ import annotations

import argparse
import math
import statistics
from contextlib import ExitStack
from contextvars import ContextVar
from pathlib import Path
from unittest import mock

import numpy as np
import scipy.fft
from curves import DEPTHS, GRID, adhesive, curve, one
from products import ALL_OF_THE_MEAN, BY_PRESSURE
from scaling import PAIR, forget, indentation, surface_of
from unit import machine, seconds, today
from variants import changed

from restitution import Contact, Grid, generate_surface, smooth, solve
from restitution.contact import adhesion, equilibrium, influence, loading
from restitution.errors import NotConvergedError
from restitution.numerics import device, nesting, passes
from restitution.numerics.convolution import FreeConvolution

OUT = Path(__file__).parents[1] / "docs" / "benchmarks" / "tricks.md"

REPORT = """\
# What each trick is worth

{date}, {machine}. Written by `make bench`.

Time without the trick over time with it, everything else as it is: medians of {rounds} turns. Every
solve or curve starts from empty caches, so that set-up and kernels count. R* = 250 µm,
E* = 112 GPa, 512² nodes of 0.25 µm but for "filling" (1024², contact all over the grid of
[scaling.md](scaling.md)); rough: Gaussian, Rq = 0.1 µm, correlation length 2 µm; plastic:
p ≤ 750 MPa; adhesive: w = 0.09 J/m², one coefficient of restitution at 600 nm; 24 depths: plastic,
rough, 2 nm to 5 µm; narrow guess: exponential autocorrelation, 0.125 µm, a = 22 µm, one of the few
contacts which the coarser grids show too small ([products.md](products.md)). "fails" where the
solve does not converge without the trick.

{table}

What is for large grids: the contacts of [scaling.md](scaling.md), the plastic ones at a = 20 µm,
medians of {few} turns.

{large_table}

What is for adhesion as the bodies approach: smooth at 30 nm, and 24 depths of a rough contact from
10 nm to 1 µm, medians of {few} turns.

{approach_table}
"""

ROUGH = generate_surface(GRID, kind="gaussian", rms=0.1e-6, correlation_length=2e-6, seed=1)


def pressed(contact: Contact, a: float):
    """A solve at δ = a²/R*."""
    return lambda: solve(contact, a * a / PAIR.radius)


def large(nodes: int, depth: str, limit: float = math.inf):
    """A solve of the benchmark of sizes, on so many nodes along an edge."""
    # Made here, not in what is timed.
    contact, delta = Contact(PAIR, surface_of(nodes), limit), indentation(depth)
    return lambda: solve(contact, delta)


FINE = Grid((512, 512), (0.125e-6, 0.125e-6))
NARROW = generate_surface(FINE, kind="exponential", rms=0.1e-6, correlation_length=2e-6, seed=2)
ADHESIVE, SMOOTH = adhesive(0.1e-6), adhesive(0.0)
JOBS = {
    "smooth, a = 10 µm": pressed(Contact(PAIR, smooth(GRID)), 10e-6),
    "rough, a = 10 µm": pressed(Contact(PAIR, ROUGH), 10e-6),
    "rough, a = 20 µm": pressed(Contact(PAIR, ROUGH), 20e-6),
    "plastic, a = 20 µm": pressed(Contact(PAIR, ROUGH, 750e6), 20e-6),
    "filling": large(1024, "filling"),
    "narrow guess": pressed(Contact(PAIR, NARROW), 22e-6),
    "24 depths": lambda: curve([Contact(PAIR, ROUGH, 750e6)], np.geomspace(2e-9, 5e-6, 24)),
    "adhesive": lambda: one(ADHESIVE, 600e-9),
}
LARGE_JOBS = {
    "2048², filling": large(2048, "filling"),
    "4096², a = 20 µm": large(4096, "a = 20 um"),
    "4096², filling": large(4096, "filling"),
    "1024², plastic": large(1024, "a = 20 um", 750e6),
    "4096², plastic": large(4096, "a = 20 um", 750e6),
}
APPROACH_JOBS = {
    "smooth, 30 nm": lambda: one(SMOOTH, 30e-9),
    "rough, 24 depths": lambda: curve([ADHESIVE], DEPTHS),
}
FEW_ROUNDS = 5  # of these


class Unchanged:
    """What takes the place of the preconditioner."""

    def __init__(self, *_: object) -> None:
        pass

    def __call__(self, r, out):
        """The residual itself."""
        out[...] = r
        return out


def everything(contact: Contact, *_: object):
    """What takes the place of the box {h₀ < δ}."""
    nx, ny = contact.grid.nodes
    return slice(0, nx), slice(0, ny)


PLAIN = device.accelerator("cpu", np, scipy.fft)
PASSES = [name for name, value in vars(passes).items() if hasattr(value, "__wrapped__")]
CONVOLUTION = [(device, "_current", ContextVar("device", default=PLAIN))]
LOOPS = [(passes, "loops", None)]
LOOPS += [(passes, name, getattr(passes, name).__wrapped__) for name in PASSES]


class OneThread:
    """While it is entered, nothing is shared among threads."""

    def __enter__(self) -> None:
        self._before = passes.loops.threads_for(2**40)
        passes.loops.use_threads(1)

    def __exit__(self, *_: object) -> None:
        passes.loops.use_threads(self._before)


LESS_MEAN = [(nesting, "_with_less_mean", changed(nesting._with_less_mean, ALL_OF_THE_MEAN))]
NO_JUMPS = [(nesting, "_NEARLY_NONE", -1.0)]

# What is given which value, or entered, so that the trick is out.
TRICKS = {
    "solve on the box {h₀ < δ}": [(module, "reach", everything) for module in (loading, adhesion)],
    "coarser grids first, and a window around their pressure": [
        (nesting, "_WORTH_A_GUESS", math.inf)
    ],
    "the window alone": [(nesting, "_WORTH_A_WINDOW", 0.0)],
    "the window as wide as what the guess leaves closed, too": [
        (equilibrium, "minimise_nested", changed(nesting.minimise_nested, *BY_PRESSURE))
    ],
    "preconditioner \\|q\\|E*/2": [(equilibrium, "inverse_half_space", Unchanged)],
    "less of the mean where its inverse is too much": LESS_MEAN,
    "jumps of the pressure between the nodes of a guess": NO_JUMPS,
    "products in single precision": [(FreeConvolution, "quick", FreeConvolution.__call__)],
    "compiled convolution": CONVOLUTION,
    "compiled loops": LOOPS,
    "both: no compiler": CONVOLUTION + LOOPS,
    "threads": [OneThread()],
    "operators and coefficients kept": [
        (influence, "_MOST_KEPT", 0),
        (influence, "_MOST_KNOWN", 0),
    ],
}
LARGE_TRICKS = {
    "threads": [OneThread()],
    "less of the mean where its inverse is too much": LESS_MEAN,
    "jumps of the pressure between the nodes of a guess": NO_JUMPS,
}
APPROACH_TRICKS = {
    "work of the approach to 1.5e-3, not 5e-4": [(loading, "_ADHESIVE_TOLERANCE", 5e-4)],
}


def timed(job, patches) -> float:
    """Seconds of a job with these patches, from empty caches; infinite if it does not converge."""
    with ExitStack() as stack:
        for patch in patches:
            stack.enter_context(mock.patch.object(*patch) if isinstance(patch, tuple) else patch)
        forget()
        try:
            return seconds(job)
        except NotConvergedError:
            return math.inf


def gain(job, patches, rounds: int) -> float:
    """Time without over time with, of a job."""
    timed(job, patches)
    ratios = []
    for turn in range(rounds):
        both = [timed(job, its) for its in ((patches, []) if turn % 2 else ([], patches))]
        without, with_it = both if turn % 2 else both[::-1]
        ratios.append(without / with_it)
    return statistics.median(ratios)


def table(tricks: dict, jobs: dict, rounds: int) -> str:
    """What every trick gains every job, as Markdown."""
    rows = [f"| without | {' | '.join(jobs)} |", "|---" * (len(jobs) + 1) + "|"]
    for name, patches in tricks.items():
        gains = [gain(job, patches, rounds) for job in jobs.values()]
        cells = [f"{its:.3g}" if its < math.inf else "fails" for its in gains]
        rows.append(f"| {name} | " + " | ".join(cells) + " |")
        print(rows[-1], flush=True)
    return "\n".join(rows)


def main() -> None:
    """Take out every trick of every job, and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--out", type=Path, default=OUT)
    options = parser.parse_args()
    report = REPORT.format(
        date=today(), machine=machine(), rounds=options.rounds, few=FEW_ROUNDS,
        table=table(TRICKS, JOBS, options.rounds),
        large_table=table(LARGE_TRICKS, LARGE_JOBS, FEW_ROUNDS),
        approach_table=table(APPROACH_TRICKS, APPROACH_JOBS, FEW_ROUNDS),
    )  # fmt: skip
    options.out.write_text(report)


if __name__ == "__main__":
    main()
