"""Join the power spectra of several scans of one surface."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from restitution.display import quantity
from restitution.errors import SurfaceError
from restitution.surfaces.joined.compare import (
    LONGEST,
    check_agreement,
    check_gaps,
    compared,
    differences,
    filled,
    overlaps_of,
    undecidable,
)
from restitution.surfaces.joined.curve import fitted_curve, used_bands
from restitution.surfaces.joined.same_place import check_places
from restitution.surfaces.joined.scan_spectrum import PER_OCTAVE, ScanSpectrum
from restitution.surfaces.joined.spectrum import Contribution, JoinedSpectrum


def join(scans: Sequence[ScanSpectrum], *, bridge: bool = False) -> JoinedSpectrum:
    """Join spectra of one surface.

    Args:
        scans: Spectra of its scans, in any order.
        bridge: Whether a power law may bridge waves that no scan shows.

    Returns:
        Joined spectrum.

    Raises:
        SurfaceError: Scans contradict each other by more than a factor of 2, leave a gap, or show
            the same place.
    """
    notes: list[str] = []
    doubts = [
        f"{scan.name} is not used: its {scan.why} leaves no waves ({quantity(scan.shortest, 'm')} "
        "is above half of its edge)"
        for scan in scans
        if scan.shortest > scan.edge / LONGEST
    ]
    spectra = sorted(
        (scan for scan in scans if scan.shortest <= scan.edge / LONGEST),
        key=lambda scan: -scan.edge,
    )
    if not spectra:
        raise SurfaceError("; ".join(doubts))
    check_places(spectra)
    check_gaps(spectra, bridge=bridge)
    curve = fitted_curve(spectra)
    spectra = [compared(scan, spectra, curve, notes, doubts) for scan in spectra]
    gaps = check_gaps(spectra, bridge=bridge)
    curve = fitted_curve(spectra)
    overlaps = tuple(overlaps_of(spectra, curve))
    check_agreement(overlaps)
    notes += [*undecidable(spectra), *filled(spectra)]
    shortest = min(scan.shortest for scan in spectra)
    longest = max(scan.edge for scan in spectra)
    spread = differences(spectra, overlaps, curve)
    whole = JoinedSpectrum(
        np.exp(curve.log_q),
        np.exp(curve.log_density),
        np.hypot(curve.error, spread),
        shortest,
        longest,
        (),
        overlaps,
        gaps,
        tuple(notes),
        tuple(doubts),
        tuple(spectra),
    )
    return replace(whole, scans=tuple(_contributions(whole, spectra)))


def _contributions(
    whole: JoinedSpectrum, spectra: Sequence[ScanSpectrum]
) -> Iterator[Contribution]:
    for scan in spectra:
        used = used_bands(scan, spectra)
        if used.any():
            waves = 2 * math.pi / scan.wave_number[used]
            half = 2 ** (0.5 / PER_OCTAVE)
            low = max(float(waves.min()) / half, scan.shortest)
            high = min(float(waves.max()) * half, scan.edge)
        else:
            low = high = scan.shortest
        yield Contribution(
            scan.name,
            scan.line,
            scan.edge,
            scan.pixel,
            low,
            high,
            scan.why if low <= scan.shortest * 1.01 else "finer scans",
            whole.rms(low, high),
            whole.slope(low, high),
        )
