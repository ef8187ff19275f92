"""Time and memory of the 24-depth rough curve of `examples/steel.toml`, in one run.

The unit U is one full-grid zero-padded convolution (forward and inverse) with scipy.fft, two
workers, float64, so that machines can be compared.
"""

from __future__ import annotations

import resource
import statistics
import time
from pathlib import Path

import numpy as np
import scipy.fft

from restitution import loading_path, unloading_path
from restitution.studies.case import read_case

EXAMPLE = Path(__file__).parents[1] / "examples" / "steel.toml"
REPEATS = 5


def convolution(n: int) -> None:
    """One U on n × n nodes."""
    p = np.ones((n, n))
    modes = scipy.fft.rfft2(p, s=(2 * n, 2 * n), workers=2)
    modes *= 1.0
    scipy.fft.irfft2(modes, s=(2 * n, 2 * n), workers=2)


def seconds(work) -> float:
    """Wall time of a call."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def main() -> None:
    """Print the medians."""
    case, _ = read_case(EXAMPLE)
    contact = case.contact(EXAMPLE.parent)
    n = contact.grid.nodes[0]
    units, curves, unloadings, states = [], [], [], []
    for _ in range(REPEATS):
        states.clear()
        units.append(seconds(lambda: convolution(n)))
        curves.append(seconds(lambda: states.extend(loading_path(contact, case.depths()))))
        unloadings.append(seconds(lambda: list(unloading_path(states[-1]))))
    U = statistics.median(units)
    print(f"U, one convolution on {n} x {n} nodes: {1e3 * U:.1f} ms")
    for name, times in (("24 depths loaded", curves), ("deepest unloaded", unloadings)):
        t = statistics.median(times)
        print(f"{name}: {t:.3f} s = {t / U:.0f} U (spread {min(times):.3f} to {max(times):.3f} s)")
    print(f"convolutions of the 24 depths: {sum(state.convolutions for state in states)}")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"peak memory: {peak:.0f} MiB")


if __name__ == "__main__":
    main()
