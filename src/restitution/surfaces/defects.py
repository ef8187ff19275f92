"""Tilt, curvature and spikes that are still in the heights of a scan."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from restitution.surfaces.clean import local_steps
from restitution.surfaces.describe import rms_slope
from restitution.surfaces.level import level, orthonormal_polynomials
from restitution.surfaces.surface import Surface

# A paraboloid counts as the form of the sample, not as long waves, if its term x² + y² holds this
# many times the mean energy of the other terms of degree 2 to 4. Terms of a higher degree are first
# multiplied by (degree/2)⁴, because the energy of self-affine surfaces falls at most like this
# (Hurst exponent 1). In 600 parts of random surfaces each, with Hurst exponents of 0.3 to 1 or
# correlation lengths of up to half of the part, at most 1 exceeded the factor.
_FORM = 20.0
_DEGREES = 4
# See `SpikePixels`. Height in standard deviations of the steps, and in Sq of the other pixels.
USUAL_THRESHOLD = 8.0
_HEIGHTS = 4.0
# Largest fraction of pixels that the usual threshold may replace. Beyond it, the threshold that
# separates the spikes is recommended instead, so that no summits are removed.
_FEW = 0.01
STEEP = 0.5  # rms slope beyond which small-slope theory is inaccurate


@dataclass(frozen=True)
class FittedForm:
    """Fractions of the height variance: of a plane, and of a sphere in what a plane leaves.

    The `radius` (m) of the sphere is negative for a hollow. `curvature` is 0 for long waves.
    """

    tilt: float = 0.0
    curvature: float = 0.0
    radius: float = np.inf


@dataclass(frozen=True)
class SpikePixels:
    """Number of spikes, largest height (m), and the `threshold` of `remove_outliers` for them."""

    count: int = 0
    height: float = 0.0
    threshold: float = USUAL_THRESHOLD


def form_of(surface: Surface) -> FittedForm:
    """Tilt and curvature that are left in the heights."""
    z = surface.height - surface.height.mean()
    total = float(np.sum(z * z))
    if total <= 0 or min(z.shape) < 3:
        return FittedForm()
    P, Q = (orthonormal_polynomials(n, _DEGREES) for n in z.shape)
    c = P.T @ z @ Q
    plane = float(c[1, 0] ** 2 + c[0, 1] ** 2)
    # Coefficients of x² + y² in the terms of degree 2, which are x² and y² less their lower terms.
    x, y = surface.grid.x, surface.grid.y
    along_x = float(P[:, 2] @ x**2 * Q[:, 0].sum())
    along_y = float(Q[:, 2] @ y**2 * P[:, 0].sum())
    norm = float(np.hypot(along_x, along_y))
    sphere = float(c[2, 0] * along_x + c[0, 2] * along_y) / norm
    saddle = float(c[2, 0] * along_y - c[0, 2] * along_x) / norm
    degree = np.add.outer(*map(np.arange, c.shape))
    higher = (c * (degree / 2) ** 2)[(degree > 2) & (degree <= _DEGREES)]
    others = np.mean(np.square([saddle, c[1, 1], *higher]))
    tilt, rest = plane / total, total - plane
    if sphere == 0 or sphere**2 <= _FORM * others:
        return FittedForm(tilt)
    return FittedForm(tilt, min(sphere**2 / rest, 1.0), -norm / (2 * sphere))


def spikes_of(surface: Surface) -> SpikePixels:
    """SpikePixels: a few pixels that stand far above the others, separated from them by a gap.

    With T the larger of 8 standard deviations of the steps above the local median and 4 Sq of the
    other pixels, pixels above 2 T are spikes if there are more than between T and 2 T. Steps down,
    which the other body does not touch, count on steep surfaces only.
    """
    from scipy.ndimage import label

    if min(surface.grid.nodes) < 5 or not _may_have_spikes(surface):
        return SpikePixels()
    step, deviation, level_height = local_steps(surface)
    if deviation <= 0:
        return SpikePixels()
    usual = np.abs(step) > USUAL_THRESHOLD * deviation
    high = max(USUAL_THRESHOLD * deviation, _HEIGHTS * float(level_height[~usual].std()))
    step = np.abs(step) if rms_slope(surface) > STEEP else step
    above, far = step > high, step > 2 * high
    if 2 * np.count_nonzero(far) <= np.count_nonzero(above):
        return SpikePixels()
    threshold = USUAL_THRESHOLD if usual.mean() <= _FEW else float(np.floor(high / deviation))
    return SpikePixels(int(label(above, np.ones((3, 3)))[1]), float(step.max()), threshold)


def _may_have_spikes(surface: Surface) -> bool:
    """Fast test: whether any pixel differs from its neighbours by far more than heights differ.

    A corner of a spike of 2 T differs from the mean of its neighbours by T or more, so by at least
    4 Sq. For uniformly distributed heights, Sq is 1.15 times their median absolute value.
    """
    height = level(surface, "curvature").height
    z = np.pad(height, 1, mode="reflect", reflect_type="odd")
    around = 0.25 * (z[2:, 1:-1] + z[:-2, 1:-1] + z[1:-1, 2:] + z[1:-1, :-2])
    return float(np.abs(height - around).max()) > _HEIGHTS * float(np.median(np.abs(height)))


def noted(surface: Surface) -> Surface:
    """Add to the provenance of a scan the defects left in it, which a part may not show."""
    form, spikes = form_of(surface), spikes_of(surface)
    more: dict[str, str | float] = {"tilt_share": form.tilt, "curvature_share": form.curvature}
    if form.curvature:
        more["curvature_radius_m"] = form.radius
    more["spikes"] = spikes.count
    if spikes.count:
        more |= {"spike_height_m": spikes.height, "spike_threshold": spikes.threshold}
    return replace(surface, provenance={**surface.provenance, **more})
