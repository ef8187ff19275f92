"""Split the waves of a surface at a wavelength: long ones for a grid, short ones for patches."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from restitution.arguments import typed
from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.noise import white_noise
from restitution.surfaces.resample import carried
from restitution.surfaces.spectra import Spectrum
from restitution.surfaces.surface import Array, Surface

_ANGLES = 32  # directions over which a spectrum is averaged
_RADII = 400  # wave numbers of an integral over a spectrum
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class SplitSurface(Surface):
    """A surface without its short waves, which are in periodic patches.

    Attributes:
        patches: Periodic surfaces with the short waves.
        wavelength: Length (m) of the shortest waves that remain, along an axis.
        place: Number of the surface among those that share the patches.
    """

    patches: tuple[Surface, ...] = ()
    wavelength: float = math.inf
    place: int = 0


@typed
def split(
    surface: Surface, wavelength: float, nodes: int, *, tiles: int = 2
) -> tuple[Surface, tuple[Surface, ...]]:
    """Split the waves of `surface`, and cut the short ones into periodic patches.

    Args:
        surface: Surface to split.
        wavelength: Length of the shortest waves that remain, along an axis (m).
        nodes: Nodes of a patch along each edge.
        tiles: Patches along each edge; they are cut from the middle of the surface.

    Returns:
        The long waves on the grid of `surface`, and `tiles`² patches or as many as it contains.

    Raises:
        SurfaceError: A patch would not contain the wavelength, or not fit the surface.
    """
    along = nodes * min(surface.grid.spacing)
    if not 2 * max(surface.grid.spacing) < wavelength <= along * (1 + _ROUNDING):
        raise SurfaceError(
            f"wavelength: {1e6 * wavelength:.4g} um is not between two cells of the surface "
            f"({2e6 * max(surface.grid.spacing):.4g} um) and the edge of a patch "
            f"({1e6 * along:.4g} um)"
        )
    if nodes > min(surface.grid.nodes):
        raise SurfaceError(
            f"nodes: a patch of {nodes} x {nodes} does not fit the surface; use fewer nodes"
        )
    long = long_waves(surface, wavelength)
    short = surface.height - long.height
    return long, cut(short, surface.grid.spacing, nodes, tiles)


def long_waves(surface: Surface, wavelength: float) -> Surface:
    """`surface` without waves shorter than `wavelength` (m) along an axis."""
    cell = 0.5 * wavelength
    return replace(surface, height=np.ascontiguousarray(carried(surface, (cell, cell))))


def cut(height: Array, spacing: tuple[float, float], nodes: int, tiles: int) -> tuple[Surface, ...]:
    """Cut up to `tiles`² periodic patches of `nodes`² nodes from the middle of `height` (m)."""
    count = [min(tiles, n // nodes) for n in height.shape]
    first = [(n - k * nodes) // 2 for n, k in zip(height.shape, count, strict=True)]
    grid = Grid((nodes, nodes), spacing)
    parts = (
        height[i : i + nodes, j : j + nodes]
        for i in range(first[0], first[0] + count[0] * nodes, nodes)
        for j in range(first[1], first[1] + count[1] * nodes, nodes)
    )
    told = {"source": "short waves", "kind": "patch", "periodicity": "periodic over the domain"}
    return tuple(Surface(_periodic(part), grid, told) for part in parts)


def _periodic(height: Array) -> Array:
    """`height` with zero mean and without the jumps between opposite edges.

    Source:
        Moisan (2011), J. Math. Imaging Vis. 39, 161–179.
    """
    from scipy.fft import irfft2, rfft2

    jumps = np.zeros_like(height)
    across, along = height[-1] - height[0], height[:, -1] - height[:, 0]
    jumps[0] += across
    jumps[-1] -= across
    jumps[:, 0] += along
    jumps[:, -1] -= along
    nx, ny = height.shape
    x, y = np.arange(nx)[:, None] / nx, np.arange(ny // 2 + 1)[None, :] / ny
    symbol = 2 * np.cos(2 * np.pi * x) + 2 * np.cos(2 * np.pi * y) - 4
    symbol[0, 0] = 1.0
    modes = rfft2(jumps) / symbol
    modes[0, 0] = 0.0
    made = height - irfft2(modes, s=height.shape)
    return np.asarray(made - made.mean())


@dataclass(frozen=True)
class Bands:
    """The waves of a generated surface: those on `grid`, and all down to `shortest` (m)."""

    spectrum: Spectrum
    grid: Grid
    shortest: float

    @property
    def carried(self) -> float:
        """Length (m) of the shortest wave that the grid carries."""
        return max(self.shortest, 2 * max(self.grid.spacing))

    def share(self) -> float:
        """Rms height of the waves that the grid carries, divided by that of all."""
        return math.sqrt(self._on_grid() / self._all())

    def short_waves(self, window: Grid, wavelength: float, rms: float, seed: int) -> Array:
        """Random heights (m) of the waves shorter than `wavelength` (m) on a periodic `window`.

        `rms` (m) is that of all waves of the surface.
        """
        from scipy.fft import irfft2, rfft2

        qx, qy = _wave_vectors(window)
        C = self.spectrum.density(qx, qy, self.grid)
        cut = 2 * math.pi / wavelength * (1 + _ROUNDING)
        C[(np.abs(qx) <= cut) & (np.abs(qy) <= cut)] = 0.0
        C[np.hypot(qx, qy) > 2 * math.pi / self.shortest * (1 + _ROUNDING)] = 0.0
        n, area = math.prod(window.nodes), math.prod(window.size)
        C *= rms**2 * n / (area * self._all())
        return np.asarray(
            irfft2(np.sqrt(C) * rfft2(white_noise(window.nodes, seed)), s=window.nodes)
        )

    def _all(self) -> float:
        from scipy.integrate import trapezoid

        q = np.geomspace(2 * math.pi / self.carried, 2 * math.pi / self.shortest, _RADII)
        angles = math.pi * np.arange(_ANGLES) / _ANGLES
        qx, qy = (np.outer(q, turn(angles)) for turn in (np.cos, np.sin))
        C = self.spectrum.density(qx, qy, self.grid).mean(axis=1)
        return self._on_grid() + float(trapezoid(C * q, q)) / (2 * math.pi)

    def _on_grid(self) -> float:
        qx, qy = _wave_vectors(self.grid)
        C = self.spectrum.density(qx, qy, self.grid)
        C[0, 0] = 0.0
        C[np.hypot(qx, qy) > 2 * math.pi / self.carried * (1 + _ROUNDING)] = 0.0
        twice = 2 * C.sum() - C[:, 0].sum()
        if self.grid.nodes[1] % 2 == 0:
            twice -= C[:, -1].sum()
        return float(twice) / math.prod(self.grid.size)


def _wave_vectors(grid: Grid) -> tuple[Array, Array]:
    (nx, ny), (hx, hy) = grid.nodes, grid.spacing
    qx, qy = 2 * np.pi * np.fft.fftfreq(nx, hx), 2 * np.pi * np.fft.rfftfreq(ny, hy)
    return np.meshgrid(qx, qy, indexing="ij")
