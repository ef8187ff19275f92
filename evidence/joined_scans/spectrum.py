r"""How far joined spectra are from the known one, with one or more scans per instrument.

    python -m evidence.joined_scans.spectrum

writes places.csv: for each number of places that each instrument scans, and ranges of waves, the
mean, the rms and the largest relative difference of C over 8 independent sets of scans.
"""

from __future__ import annotations

import csv
import math
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np

from restitution.surfaces import level
from restitution.surfaces.joined.join import join
from restitution.surfaces.joined.scan_spectrum import ScanSpectrum

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from virtual_instruments import KnownSurface

KNOWN, PIXELS, SETS = KnownSurface(), 192, 8
# Edge (m), blur and noise (m) of three instruments.
INSTRUMENTS = ((300e-6, 0.5e-6, 2e-9), (30e-6, 0.0, 0.5e-9), (2.5e-6, 0.0, 0.0))
ENDS = (300e-6, 150e-6, 100e-6, 30e-6, 3e-6, 0.3e-6, 0.026e-6)


def scan(kind: int, seed: int) -> ScanSpectrum:
    """The spectrum of a scan of instrument number `kind`."""
    edge, blur, noise = INSTRUMENTS[kind]
    seen = KNOWN.scan(edge, PIXELS, 1000 * seed + kind, smoothing=blur, noise=noise)
    return ScanSpectrum.of(level(seen, "curvature"), 2, f"{kind}-{seed}")


def main() -> None:
    """Write the table."""
    with Path(__file__).with_name("places.csv").open("w") as file:
        writer = csv.writer(file)
        header = "mean", "rms", "largest", "within_2_errors", "slope_ratio"
        writer.writerow(("places", "from_um", "to_um", *header))
        for places in (1, 4, 16):
            sets = []
            for first in range(SETS):
                seeds = range(100 * places + first * places, 100 * places + (first + 1) * places)
                one = [scan(kind, seed) for seed in seeds for kind in range(3)]
                joined = join(one)
                q = joined.wave_number
                known = KNOWN.density(q)
                slope = joined.slope(joined.shortest, joined.longest)
                ratio = slope / KNOWN.slope(joined.shortest, joined.longest)
                sets.append((q, joined.density / known - 1, joined.error, joined.at(q) > 0, ratio))
            for high, low in pairwise(ENDS):
                off, sure = [], []
                for q, difference, error, inside, _ in sets:
                    wave = 2 * math.pi / q
                    kept = inside & (wave <= high) & (wave > low)
                    off.append(difference[kept])
                    sure.append(np.abs(np.log1p(difference[kept])) < 2 * error[kept])
                mean = np.mean(off, axis=0)
                values = (
                    mean[np.abs(mean).argmax()],
                    np.sqrt(np.mean(np.square(off))),
                    np.abs(off).max(),
                    np.mean(sure),
                    np.mean([ratio for *_, ratio in sets]),
                )
                writer.writerow(
                    (
                        places,
                        f"{1e6 * high:g}",
                        f"{1e6 * low:g}",
                        *(f"{value:.3f}" for value in values),
                    )
                )
                file.flush()


if __name__ == "__main__":
    main()
