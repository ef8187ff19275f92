r"""Predicted and observed scatter of joined spectra between places, of 20 sets of three scans.

    python -m evidence.joined_scans.scatter

writes scatter.csv: for ranges of waves, the rms over the sets of the predicted scatter of ln C, of
the error that the program states, and of the actual difference from the known spectrum, with one
and four places.
"""

from __future__ import annotations

import csv
import math
import sys
from pathlib import Path

import numpy as np

from restitution.surfaces import level
from restitution.surfaces.joined.join import join
from restitution.surfaces.joined.places import ranges, scatter_in
from restitution.surfaces.joined.scan_spectrum import ScanSpectrum

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from virtual_instruments import KnownSurface

KNOWN, PIXELS, SETS = KnownSurface(), 96, 20
EDGES = 150e-6, 15e-6, 1.5e-6


def joined(seed, places):
    return join(
        [
            ScanSpectrum.of(
                level(KNOWN.scan(edge, PIXELS, 1000 * seed + 10 * place + kind), "curvature"),
                2,
                f"{kind}-{place}",
            )
            for place in range(places)
            for kind, edge in enumerate(EDGES)
        ]
    )


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def in_waves(one, values, waves):
    q = np.geomspace(2 * math.pi / waves[1], 2 * math.pi / waves[0], 33)
    return rms(np.interp(np.log(q), np.log(one.wave_number), values))


def main():
    with Path(__file__).with_name("scatter.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("places", "from_um", "to_um", "predicted", "stated_error", "observed"))
        single = [joined(seed, 1) for seed in range(SETS)]
        for places in (1, 4):
            sets = single if places == 1 else [joined(100 + seed, 4) for seed in range(SETS)]
            for waves in ranges(single[0], 0.0, 1.0):
                # From one place alone, as `check` predicts it.
                predicted = rms([scatter_in(one, waves, places) for one in single])
                stated = rms([in_waves(one, one.error, waves) for one in sets])
                off = [np.log(one.density / KNOWN.density(one.wave_number)) for one in sets]
                observed = rms([in_waves(*pair, waves) for pair in zip(sets, off, strict=True)])
                ends = [f"{1e6 * wave:.3g}" for wave in waves]
                numbers = [f"{value:.3f}" for value in (predicted, stated, observed)]
                writer.writerow((places, *ends, *numbers))
                file.flush()


if __name__ == "__main__":
    main()
