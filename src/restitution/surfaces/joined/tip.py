"""Waves that a probe of finite radius does not resolve."""

from __future__ import annotations

import numpy as np

from restitution.surfaces.surface import Array, Surface

_SHARE = 0.5  # of the curvature of the tip, from which the scan shows the tip


def tip_cut_off(surface: Surface, radius: float) -> float:
    """The wave (m) below which a tip of `radius` (m) shapes the scan; 0 if it does not.

    Where the sharpest summit at a distance has half the curvature of the tip: Sanner, Nöhring,
    Thimons, Jacobs and Pastewka (2022), Appl. Surf. Sci. Adv. 7, 100190.
    """
    reached = 0.0
    for axis, h in enumerate(surface.grid.spacing):
        z = np.moveaxis(surface.height, axis, 0)
        if z.shape[0] < 3:
            continue
        longest = (z.shape[0] - 1) // 2
        for step in np.unique(np.geomspace(1, longest, 60).astype(int)):
            if _sharpest(z, int(step), h) * radius >= _SHARE:
                reached = max(reached, 2 * int(step) * h)
    return reached


def _sharpest(z: Array, step: int, h: float) -> float:
    """Largest curvature (1/m) of a summit from points `step` pixels apart."""
    second = 2 * z[step:-step] - z[: -2 * step] - z[2 * step :]
    return float(second.max()) / (step * h) ** 2
