"""Levelling: subtract the tilt and the form of the sample from a scan."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from restitution.arguments import typed
from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.surface import Array, Surface

Levelling = Literal["none", "center", "tilt", "curvature"]
_DEGREE = {"center": 0, "tilt": 1, "curvature": 2}


@typed
def level(surface: Surface, how: Levelling) -> Surface:
    """Subtract the mean, or the least-squares plane or paraboloid, from the heights.

    Args:
        surface: Surface to level.
        how: Method, `none`, `center` (mean), `tilt` (plane) or `curvature` (paraboloid).

    Returns:
        Levelled surface. The provenance lists all methods so far (`levelling`) and the radius of
        the paraboloid's mean curvature (`subtracted_radius_m`), negative for a hollow.

    Raises:
        SurfaceError: `how` is unknown.
    """
    if how not in get_args(Levelling):
        raise SurfaceError(
            f"how={how!r} is unknown; choose one of {', '.join(get_args(Levelling))}"
        )
    before = str(surface.provenance.get("levelling", "none"))
    done = [step for step in (before, how) if step != "none"]
    provenance = {**surface.provenance, "levelling": ", ".join(done) or "none"}
    height = surface.height
    if how != "none":
        form = _least_squares_form(height, _DEGREE[how])
        height = height - form
        if how == "curvature" and (curvature := _mean_curvature(form, surface.grid)):
            provenance["subtracted_radius_m"] = -1 / curvature
    return replace(surface, height=height, provenance=provenance)


def _mean_curvature(paraboloid: Array, grid: Grid) -> float:
    """Mean curvature (1/m) of a paraboloid; 0 with fewer than 3 pixels along an axis."""
    if min(paraboloid.shape) < 3:
        return 0.0
    along_x, along_y = paraboloid[:3, 0], paraboloid[0, :3]
    hx, hy = grid.spacing
    return 0.5 * float(np.diff(along_x, 2)[0] / hx**2 + np.diff(along_y, 2)[0] / hy**2)


def _least_squares_form(height: Array, degree: int) -> Array:
    P, Q = (orthonormal_polynomials(n, degree) for n in height.shape)
    coefficients = P.T @ height @ Q
    power_x, power_y = np.indices(coefficients.shape)
    coefficients[power_x + power_y > degree] = 0.0
    return np.asarray(P @ coefficients @ Q.T)


def orthonormal_polynomials(n: int, degree: int) -> Array:
    """Polynomials of degree 0 to `degree` (at most n − 1) on n equidistant points, as columns."""
    s = np.linspace(-1.0, 1.0, n) if n > 1 else np.zeros(1)
    return np.linalg.qr(np.vander(s, min(degree + 1, n), increasing=True)).Q
