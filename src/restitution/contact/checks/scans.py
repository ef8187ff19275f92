"""Checks of the heights of a contact: tilt, curvature and spikes of scans, and steepness."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from restitution.contact.checks.findings import (
    CurvedScan,
    Finding,
    ImpossibleSlope,
    Spikes,
    SteepSurface,
    TiltedScan,
)
from restitution.surfaces import Surface, rms_slope
from restitution.surfaces.defects import STEEP, FittedForm, SpikePixels, form_of, spikes_of

_TILTED = 0.5  # fraction of the variance of the heights that a plane explains
# Fraction of the remaining variance that a sphere explains. On the edge of such a scan, the sphere
# is at least 1.6 times as deep as Sq of the roughness.
_CURVED = 0.3
# The largest fraction that waves of a periodic surface explain is 0.92, that of one wave per axis.
_CURVED_PERIODIC = 0.95
# Curvature of the scan times R*. Below the range, the force at a given indentation changes by less
# than 5 %. Above it, the curvature is that of a texture, not of the particle.
_DOUBLED = (0.1, 10.0)
# Rms slope beyond which a contact is refused. Real surfaces have rms slopes of 0.003 to 2. Heights
# in a wrong unit are at least 1000 times too large, so their slope exceeds 3. Small-slope theory
# would be meaningless there: the mean flank is steeper than 70 degrees.
STEEPEST = 3.0

_Provenance = Mapping[str, str | float]


def scan_findings(surface: Surface, reduced_radius: float = math.inf) -> list[Finding]:
    """Find reasons to doubt the heights of `surface`, in contact with the reduced radius R* (m)."""
    by_file: dict[tuple[object, ...], Finding] = {}
    for before in _scans(surface.provenance):
        for finding in _of_scan(surface, before, reduced_radius):
            by_file.setdefault((type(finding), finding.file), finding)
    findings = list(by_file.values())
    slope = rms_slope(surface)
    if slope > STEEP and not any(isinstance(finding, Spikes) for finding in findings):
        findings.append(SteepSurface(slope, STEEP))
    return findings


def too_steep(surface: Surface) -> Spikes | ImpossibleSlope | None:
    """Return a finding if slopes are meaningless: spikes first, because they may be the reason."""
    if (slope := rms_slope(surface)) <= STEEPEST:
        return None
    spikes = (finding for finding in scan_findings(surface) if isinstance(finding, Spikes))
    file = str(surface.provenance.get("file", ""))
    return next(spikes, None) or ImpossibleSlope(slope, STEEPEST, file)


def _scans(provenance: _Provenance) -> list[str]:
    """The prefix of the provenance entries of each scan; "" if the surface is one scan."""
    measured = [key for key, value in provenance.items() if value == "measured"]
    keys = [key for key in measured if key.endswith("source")]
    keys += [key for key in provenance if key.endswith("levelling")]
    return list(dict.fromkeys(key.removesuffix("source").removesuffix("levelling") for key in keys))


def _of_scan(
    surface: Surface, before: str, reduced_radius: float
) -> Iterator[Spikes | TiltedScan | CurvedScan]:
    provenance = surface.provenance
    file = str(provenance.get(f"{before}file", provenance.get("file", "the surface")))
    steps = str(provenance.get(f"{before}levelling", "none")).split(", ")
    spikes = _spikes(surface, before)
    if spikes.count:
        yield Spikes(file, spikes.count, spikes.height, spikes.threshold)
    if "curvature" in steps:
        return
    form = _form(surface, before)
    curved = _is_curved(form, reduced_radius)
    if form.tilt > _TILTED and "tilt" not in steps:
        yield TiltedScan(file, form.tilt, curved)
    if curved:
        yield CurvedScan(file, form.curvature, form.radius, reduced_radius)


def _is_curved(form: FittedForm, reduced_radius: float) -> bool:
    if math.isinf(reduced_radius):
        return form.curvature > _CURVED_PERIODIC
    low, high = _DOUBLED
    return form.curvature > _CURVED and low <= reduced_radius / abs(form.radius) <= high


def _form(surface: Surface, before: str) -> FittedForm:
    if (tilt := surface.provenance.get(f"{before}tilt_share")) is None:
        return form_of(surface)
    curvature = surface.provenance.get(f"{before}curvature_share", 0.0)
    radius = surface.provenance.get(f"{before}curvature_radius_m", math.inf)
    return FittedForm(float(tilt), float(curvature), float(radius))


def _spikes(surface: Surface, before: str) -> SpikePixels:
    if (count := surface.provenance.get(f"{before}spikes")) is None:
        return spikes_of(surface)
    names = ("spike_height_m", "spike_threshold")
    return SpikePixels(
        int(count), *(float(surface.provenance.get(f"{before}{name}", 0.0)) for name in names)
    )
