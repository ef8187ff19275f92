"""Time one large solve on a GPU, and compare its pressure with that of the CPU.

Needs CuPy and a GPU (`pip install ".[gpu]"`). `--device cpu` times the same solve on the
CPU. `--nodes` sets the size of the grid.
"""

from __future__ import annotations

import argparse
import statistics
import time

import numpy as np
from scaling import PAIR, indentation, surface_of
from unit import machine, today

from restitution import Contact, on_device, solve

BANDWIDTH = 3.35e12  # bytes/s: H100 SXM5, its data sheet


def seconds(work, repeats: int) -> tuple[float, object]:
    """Return the median time of a call, after one call that is not counted, and its last result."""
    answer = work()
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        answer = work()
        times.append(time.perf_counter() - began)
    return statistics.median(times), answer


def least_seconds(n: int, products: int) -> float:
    """Time (s) to move the arrays of a solve on n × n nodes at the bandwidth of the device.

    In single precision the padded half-complex array has 16n² bytes. A product K p fills this
    array, transforms it twice and multiplies it by the kernel. Each of these steps reads and writes
    the array: 110n² bytes. The rows and the converted arrays take 60n² bytes. The preconditioner is
    applied once for each product and is not padded: 60n² bytes. An iteration reads or writes about
    40 arrays of n² values in double precision.
    """
    return products * (110 + 60 + 60 + 40 * 8) * n**2 / BANDWIDTH


def large(device: str, n: int) -> None:
    """Time the elastic solve of `scaling.py` at a contact radius of 20 µm on n × n nodes; print."""
    contact = Contact(PAIR, surface_of(n))
    depth = indentation("a = 20 µm")
    assert contact.gap.shape == (n, n)
    with on_device(device):
        t, state = seconds(lambda: solve(contact, depth), 3)
    limit = least_seconds(n, state.convolutions)
    print(
        f"{n} x {n} rough, elastic, a = 20 µm: {t:.3f} s on {device}, {state.convolutions} "
        f"products, residual {state.residual:.1e}; bandwidth alone {limit:.3f} s"
    )
    if device != "cpu":
        here = solve(contact, depth)
        off = np.abs(state.box_pressure - here.box_pressure).max() / here.box_pressure.max()
        print(
            f"  largest difference from the pressure of the CPU: {off:.1e} of the largest pressure"
        )


def main() -> None:
    """Print the time of the solve."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--device", default="gpu")
    parser.add_argument("--nodes", type=int, default=4096)
    options = parser.parse_args()
    print(f"{today()}, {machine()}")
    large(options.device, options.nodes)


if __name__ == "__main__":
    main()
