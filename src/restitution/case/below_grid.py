"""Which waves of the roughness the grid leaves to patches, and these patches."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from restitution.case.roughness_keys import ADHESIVE_CELLS, CELLS, BelowGrid, Stamp
from restitution.case.tables import CaseTables
from restitution.contact.checks.resolution import divisions, predicted_radius
from restitution.display import quantity
from restitution.errors import CaseError, RestitutionError
from restitution.numerics import memory
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, refine, rms_slope
from restitution.surfaces.refine import FACTORS, divided
from restitution.surfaces.split import SplitSurface, cut, long_waves

_LESS = 0.99  # keeps a limit valid that is printed with four digits
# Edge of a patch divided by the longest wave in it; patches that adhere are solved more slowly.
_EDGE, _ADHESIVE_EDGE = 8.0, 4.0
_LEAST_EDGE = 2.0  # the least such ratio, on a scan that is too small
TILES = 2  # patches along each edge of the window from which they are cut
_MOST_NODES = 2048  # along the edge of a patch
_BYTES = 250.0  # per node of a window
_MOST_REFINED = 512  # nodes along the edge of a patch that is refined for its adhesion
# By default the waves of a scan go into patches if bodies yield without adhesion, if half an octave
# is below the split, and if the contact radius is at least so many splits at the largest depth. If
# the bound grows, all indentations must be at least the rms height: the error of contacts on fewer
# asperities holds too rarely (evidence/two_scales/dry.csv).
_MATTERING, _SEPARATE = 0.71, 2.0
_MOST_BY_DEFAULT = 512  # nodes along the edge of such a patch, for some 10 s of solves
_REACH = 0.5  # cell divided by sqrt(r z₀) for asperities of radius r (docs/adhesion.md)


@dataclass(frozen=True)
class Splitting:
    """How a surface is split at `wavelength` (m): patches of `nodes`² cells of `cell` (m)."""

    wavelength: float
    cell: float
    nodes: int
    tiles: int = TILES

    @property
    def window(self) -> Grid:
        """The grid that is cut into patches."""
        n = self.tiles * self.nodes
        return Grid((n, n), (self.cell, self.cell))


def splitting_of(case: CaseTables, folder: Path) -> Splitting | None:
    """How the surface of `case` is split; None if it is not.

    Raises `CaseError` if a split is needed or given, but impossible.
    """
    grid = case.grid.grid()
    if grid is None or not case.roughness:
        return None
    if _choice(case) is None and not _adds_waves(case, grid):
        with suppress(RestitutionError):  # whoever makes the contact says what is wrong
            return _where_waves_matter(case, folder)
        return None
    wanted = _wanted(case, folder)
    if wanted is None:
        return None
    radius = _radius(case)
    if wanted.split > radius:
        raise CaseError(_not_separate(case, wanted, radius))
    return _sized(case, folder, wanted)


def _where_waves_matter(case: CaseTables, folder: Path) -> Splitting | None:
    if case.interface.adhesive_energy or math.isinf(case.yielding().hardness):
        return None
    wanted = _wanted(case, folder)
    if wanted is None or wanted.shortest > _MATTERING * wanted.split:
        return None
    if _SEPARATE * wanted.split > _radius(case):
        return None
    if _on_few_asperities(case, folder):
        return None
    sized = _sized(case, folder, wanted)
    return sized if sized.nodes <= _MOST_BY_DEFAULT else None


def _on_few_asperities(case: CaseTables, folder: Path) -> bool:
    return is_on_few_asperities(case, folder, case.depths()[0])


def is_on_few_asperities(case: CaseTables, folder: Path, depth: float) -> bool:
    """Whether a `depth` of the case is so small that errors with patches hold too rarely."""
    if not case.yielding().model.grows:
        return False
    rms = math.hypot(*(part.rms_height(folder) for part in case.roughness))
    return case.indentation_at(depth) < rms


def refines_for_patches(case: CaseTables, folder: Path) -> bool:
    """Whether the grid of `case` is refined where its contacts are small beside its patches.

    It is if patches are asked for, bodies yield without adhesion, and `refine` and `split` are not
    given. Finer cells carry more waves of a scan, but no more of a generated surface.
    """
    grid = case.grid.grid()
    if grid is None or "refine" in case.grid.model_fields_set or _choice(case) != "patch":
        return False
    if case.interface.adhesive_energy or math.isinf(case.yielding().hardness):
        return False
    wanted = None if _given(case) or _adds_waves(case, grid) else _wanted(case, folder)
    return wanted is not None


def _radius(case: CaseTables) -> float:
    """Contact radius (m) of smooth bodies at the largest depth."""
    deepest = case.indentation_at(case.depths()[-1])
    return predicted_radius(case.pair(), deepest, case.yielding().hardness)


def notice_of(case: CaseTables, folder: Path) -> str | None:
    """One line if patches were asked for, but have no waves or an error that holds too rarely."""
    if _choice(case) != "patch":
        return None
    wanted = _wanted(case.refined(case.factors()[0]), folder)
    if wanted is None and _wanted(case.refined(1), folder) is None:
        return "roughness.below_grid: no waves are below the grid, so nothing is split"
    if wanted is None:
        return None
    if not case.interface.adhesive_energy and _on_few_asperities(case, folder):
        return (
            "roughness.below_grid: the smallest indentation is below the rms height; where few "
            "asperities carry a contact and the bound grows, COR with patches can be off by more "
            f"than its error. Use {_carrying(case, wanted)}, or only the larger depths"
        )
    return None


def _carrying(case: CaseTables, wanted: _Wanted) -> str:
    """Keys of a grid that carries all waves."""
    grid = case.grid.grid()
    assert grid is not None
    factor = divisions(max(grid.spacing), wanted.cell)
    if _adds_waves(case, grid) or factor > FACTORS[-1]:
        return "a smaller grid.spacing"
    nx, ny = divided(grid, factor).nodes
    return f"grid.refine = {factor} ({nx} x {ny} nodes)"


class _Wanted(NamedTuple):
    split: float  # wavelength (m)
    least: float  # the shortest wave (m) of the grid
    shortest: float  # the shortest wave (m) of the patches
    cell: float  # of the patches (m)


def _wanted(case: CaseTables, folder: Path) -> _Wanted | None:
    parts, grid = case.roughness, case.grid.grid()
    choice = _choice(case)
    if grid is None or not parts or choice == "omit":
        return None
    if not _can_split(case):
        if choice is None:
            return None
        raise CaseError(
            'roughness.below_grid: "patch" is not defined with adhesion = "jkr" (or a key that '
            'needs it), plasticity = "truncated", [impacts], a periodic grid, skewness or '
            "kurtosis; leave below_grid and split out"
        )
    added = _adds_waves(case, grid)
    # A finer grid carries more waves of a scan, but no more waves of a generated surface.
    fine = divided(grid, case.grid.factor)
    least = 2 * max(grid.spacing if added else fine.spacing)
    split = _given(case) or max(_cells(case) * max(fine.spacing), least)
    cell = min(part.patch_cell(grid, folder) for part in parts)
    shortest = min(part.shortest_wave(grid, folder) for part in parts)
    if shortest > split * (1 - 1e-9):
        return None
    if split < least * (1 - 1e-9):
        raise CaseError(
            f"roughness.split: {_nm(split)} is below two grid spacings ({_nm(least)}), so waves in "
            "between would be in neither the grid nor the patches; use a larger split or a smaller "
            "grid.spacing"
        )
    return _Wanted(split, least, shortest, cell)


def _adds_waves(case: CaseTables, grid: Grid) -> bool:
    return any(part.needs_patches(grid) for part in case.roughness)


def _cells(case: CaseTables) -> int:
    return ADHESIVE_CELLS if case.interface.adhesive_energy else CELLS


def _not_separate(case: CaseTables, wanted: _Wanted, radius: float) -> str:
    """Why waves and contact do not separate, with values that do."""
    split, most = _nm(wanted.split), _LESS * radius
    spacing = f"set grid.spacing to {_nm(most / _cells(case))} or less"
    without = _without_patches(case, wanted)
    at = f"contact radius of {_nm(radius)} at the largest depth"
    if _choice(case) is None:
        return (
            f"roughness.shortest: is below two grid spacings, and patches of waves up to {split} "
            f"would not be small beside the {at}; {spacing}, or {without}"
        )
    if _given(case) is not None:
        shorter = f"set split to {_nm(most)} or less"
        spacing = shorter if wanted.least <= most else f"leave split out and {spacing}"
    return (
        f"roughness.split: {split} is above the {at}, so waves and contact do not separate; "
        f"{spacing}, or {without}"
    )


def _without_patches(case: CaseTables, wanted: _Wanted) -> str:
    grid = case.grid.grid()
    if grid is not None and _adds_waves(case, grid):
        kept = float(f"{wanted.least:.4g}") >= wanted.least * (1 - 1e-9)
        return f"roughness.shortest to {_nm(wanted.least / (1 if kept else _LESS))} or more"
    return 'below_grid = "omit"'


def _can_split(case: CaseTables) -> bool:
    """Whether the models and surfaces of the case are defined with waves below the grid."""
    interface = case.interface
    jkr = interface.adhesion == "jkr" or interface.needs_jkr
    if case.impacts or case.periodic or (interface.adhesive_energy and jkr):
        return False
    normal = all(part.is_normal for part in case.roughness)
    return normal and case.yielding().model.bounds_solve


def _choice(case: CaseTables) -> BelowGrid | None:
    given = next((part.below_grid for part in case.roughness if part.below_grid), None)
    return given or ("patch" if _given(case) else None)


def _given(case: CaseTables) -> float | None:
    return next((part.split for part in case.roughness if part.split), None)


def _sized(case: CaseTables, folder: Path, wanted: _Wanted) -> Splitting:
    from scipy.fft import next_fast_len

    split, cell = wanted.split, wanted.cell
    room = min(part.patch_room(folder) for part in case.roughness)
    edge = min((_ADHESIVE_EDGE if case.interface.adhesive_energy else _EDGE) * split, room)
    if edge < _LEAST_EDGE * split:
        raise CaseError(
            f"roughness.split: {_nm(split)} is too long for patches from a scan of {_nm(room)}; "
            f"set split to {_nm(_LESS * room / _LEAST_EDGE)} or less, or roughness.extend = "
            '"twin" with a seed'
        )
    nodes = math.floor(edge / cell * (1 + 1e-9))
    if edge < room:
        nodes = next_fast_len(math.ceil(edge / cell * (1 - 1e-9)), real=True)
    tiles = max(1, math.floor(min(TILES, room / (nodes * cell) * (1 + 1e-9))))
    needed = _BYTES * (tiles * nodes) ** 2
    if nodes > _MOST_NODES or needed > memory.available():
        raise CaseError(
            f"roughness.split: patches of {nodes} x {nodes} nodes ({_nm(cell)} each, for waves "
            f"below {_nm(split)}) are too large; use a smaller grid.spacing or split, or set "
            f"{_without_patches(case, wanted)}"
        )
    return Splitting(split, cell, nodes, tiles)


def split_surface(case: CaseTables, folder: Path, surface: Surface, how: Splitting) -> SplitSurface:
    """`surface` of `case` without short waves, and the patches that have them."""
    kin = tuple(part.of_patches() for part in case.roughness)
    stamps = tuple(part.stamp(folder) for part in case.roughness)
    patches = _patches(kin, str(folder), stamps, case.grid.grid(), how)
    if case.interface.adhesive_energy:
        z0 = case.interface.equilibrium_separation
        patches = tuple(_resolved(patch, z0) for patch in patches)
    long = long_waves(surface, how.wavelength)
    gone = ("pixel_x_m", "pixel_y_m", "shortest_carried_m", "removed_rms_m", "removed_slope")
    told = {key: value for key, value in surface.provenance.items() if key not in gone}
    (nx, ny), (cell, _) = patches[0].grid.nodes, patches[0].grid.spacing
    told |= {
        "split_m": how.wavelength,
        "patches": f"{len(patches)} of {nx} x {ny} nodes of {_nm(cell)}",
        "patch_rms_m": float(np.sqrt(np.mean([patch.height.var() for patch in patches]))),
        "patch_slope": float(np.sqrt(np.mean([rms_slope(patch) ** 2 for patch in patches]))),
    }
    place = sum(part.number for part in case.roughness)
    return SplitSurface(long.height, surface.grid, told, patches, how.wavelength, place)


@lru_cache(maxsize=8)
def _patches(
    parts: Sequence[Any], folder: str, _: tuple[Stamp, ...], grid: Grid, how: Splitting
) -> tuple[Surface, ...]:
    heights = [part.short_waves(how.window, how.wavelength, grid, Path(folder)) for part in parts]
    return cut(np.sum(heights, axis=0), how.window.spacing, how.nodes, how.tiles)


@lru_cache(maxsize=32)
def _resolved(patch: Surface, z0: float) -> Surface:
    """`patch` on cells that resolve the adhesion of its asperities."""
    hx, z = patch.grid.spacing[0], patch.height
    curvature = (np.roll(z, 1, 0) + np.roll(z, -1, 0) - 2 * z) / hx**2
    radius = 1 / max(float(curvature.std()), 1e-300)
    factor = 1
    while hx / factor > _REACH * math.sqrt(radius * z0) and (
        2 * factor * patch.grid.nodes[0] <= _MOST_REFINED
    ):
        factor *= 2
    return refine(patch, factor)


def _nm(length: float) -> str:
    return quantity(length, "m")
