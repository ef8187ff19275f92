"""Time and memory of the 24-depth rough curve of `examples/steel.toml`, in one run.

Times are also given in the unit U of `unit.py`, so that machines can be compared.
"""

from __future__ import annotations

import resource
import statistics
from pathlib import Path

from unit import convolution, seconds

from restitution import loading_path, unloading_path
from restitution.studies.case import read_case

EXAMPLE = Path(__file__).parents[1] / "examples" / "steel.toml"
REPEATS = 5


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
