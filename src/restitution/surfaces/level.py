"""Levelling: what a scan shows of the tilt and the form of its sample, taken out."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from restitution.errors import SurfaceError
from restitution.surfaces.surface import Surface

Levelling = Literal["none", "center", "tilt", "curvature"]
_DEGREE = {"center": 0, "tilt": 1, "curvature": 2}


def level(surface: Surface, how: Levelling) -> Surface:
    """Subtract the least-squares mean, plane or paraboloid (1, x, y, x², xy, y²) of the heights.

    `how` is "none", "center" (mean), "tilt" (plane) or "curvature" (paraboloid). The provenance
    entry `levelling` lists what was subtracted, in order. Raises `SurfaceError` for another
    `how`.
    """
    if how not in get_args(Levelling):
        raise SurfaceError(
            f"levelling: {how!r} is unknown; choose one of {', '.join(get_args(Levelling))}"
        )
    before = [str(surface.provenance["levelling"])] if "levelling" in surface.provenance else []
    done = [step for step in [*before, how] if step != "none"]
    height = surface.height
    if how != "none":
        height = height - _least_squares_form(height, _DEGREE[how])
    return replace(
        surface,
        height=height,
        provenance={**surface.provenance, "levelling": ", ".join(done) or "none"},
    )


def _least_squares_form(height: NDArray[np.float64], degree: int) -> NDArray[np.float64]:
    """Polynomial of total degree `degree` closest to the heights, shape (nx, ny).

    On a regular grid the products of the two axes' orthonormal polynomials are themselves
    orthonormal, so the fit is a projection: no matrix with a row for each pixel is needed.
    """
    P, Q = (_orthonormal_polynomials(n, degree) for n in height.shape)
    coefficients = P.T @ height @ Q
    power_x, power_y = np.indices(coefficients.shape)
    coefficients[power_x + power_y > degree] = 0.0
    form: NDArray[np.float64] = P @ coefficients @ Q.T
    return form


def _orthonormal_polynomials(n: int, degree: int) -> NDArray[np.float64]:
    """Columns 0…degree (as many as n points can tell apart) on n equidistant points."""
    s = np.linspace(-1.0, 1.0, n) if n > 1 else np.zeros(1)
    return np.linalg.qr(np.vander(s, min(degree + 1, n), increasing=True)).Q
