"""The total error of every COR of a run, due to solver, grid, surface and materials.

docs/error.md has the formulas (n, S, S_h, S_2h, q, D, p, p_S), and how often the error holds.
Their constants were chosen on about 1000 random cases, 30 of them adhesive.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from restitution.case.case import Case
from restitution.contact.checks.resolution import divisions
from restitution.curve.columns import Array, array
from restitution.curve.curve import largest
from restitution.curve.point import Point
from restitution.display import counted
from restitution.numerics.intervals import half_interval
from restitution.runs.attraction import with_pull_off_errors
from restitution.runs.companions import SURFACES, Companions
from restitution.runs.log import Say, ignore
from restitution.runs.loss_errors import with_sticking
from restitution.runs.material_advice import MaterialPart, advice, as_rows
from restitution.runs.material_parts import material_parts
from restitution.runs.scale_curves import ScaleCurves
from restitution.surfaces import Surface, rms_slope
from restitution.surfaces.refine import coarsen

# The grid leaves out short waves. The expected change of COR due to these waves is multiplied by
# this safety factor.
_BAND = 1.5
# The fraction s (see the top of this file), interpolated between its values at 3 and at 7 nodes in
# the median patch.
_FEW_NODES, _SHARE = (3, 7), (0.6, 0.1)
# The error f of COR as a function of the number of nodes in the median patch. In about 90 % of the
# contacts, the difference from the solution on a finer grid was below f. A patch of one node yields
# late and all at once, so contacts with such patches may have almost any error of COR.
_PATCH_NODES = (1, 3, 7, 14, 30, 100, 400)
_PATCH_ERROR = (0.9, 0.4, 0.15, 0.08, 0.05, 0.024, 0.008)
# Differences of COR between grids and between surfaces are smoothed over the loading work, because
# single differences may vanish by chance. These are the widths of the smoothing in ln(work).
_NEAR_GRID, _NEAR_SURFACE = 2.0, 1.0
MOST_AFFORDABLE = 2**24  # largest recommended number of nodes (takes some minutes and 2 GB)

# A row counts as resolved only if the error of COR due to omitted waves is at most this value.
MISSING_BAND = 0.03

NOT_INCLUDED = (
    "the model (range of adhesion and model of plasticity, see model_error; half-space), values "
    "given in the case file, rate effects of yielding"
)


@dataclass(frozen=True)
class OmittedWaves:
    """The waves that a grid leaves out of a scan (docs/error.md).

    `octaves` is n (0 if none is left out), `slope` S and `coarser_slope` S_2h. `removed_slope` is
    the rms slope of the omitted waves divided by S. `pixel` is the spacing (m) that resolves them.
    """

    octaves: float
    slope: float
    coarser_slope: float
    removed_slope: float
    pixel: float

    @classmethod
    def of(cls, surface: Surface) -> OmittedWaves:
        provenance = surface.provenance
        removed = float(provenance.get("removed_slope", 0.0))
        pixel = max(float(provenance.get(f"pixel_{axis}_m", 0.0)) for axis in "xy")
        slope, coarser = rms_slope(surface), rms_slope(coarsen(surface))
        if coarser == 0:
            return cls(0.0, 0.0, 0.0, removed, pixel)
        beyond = -0.5 * math.log(max(1 - removed**2, 1e-4))
        octaves = beyond / math.log(max(slope / coarser, 1.05)) if removed >= 1e-3 else 0.0
        return cls(octaves, slope * math.exp(beyond), coarser, removed, pixel)

    def pressure_ratio(self, force: float, area: float, contact_modulus: float) -> float:
        """Ratio p/p_S for a force (N) on a contact area (m²)."""
        if self.slope <= self.coarser_slope:
            return 1.0
        smallest = (self.coarser_slope / self.slope) ** 2
        if force <= 0 or area == 0:  # possible with adhesion
            return smallest
        added = 0.5 * contact_modulus * math.sqrt(self.slope**2 - self.coarser_slope**2)
        return max(force / math.hypot(force, added * area), smallest)


def unseen_yield(companions: Companions, waves: OmittedWaves, points: Sequence[Point]) -> Array:
    """Error q² D of COR of `points` due to nodes that would yield only on a finer grid."""
    work = array(points, "loading_work")
    stored, plastic = array(points, "stored_energy"), array(points, "plastic_work")
    E_star = companions.coarse.pair.contact_modulus
    ratios = [
        waves.pressure_ratio(point.force, point.contact_area, E_star)
        for point in sorted(points, key=lambda point: point.indentation)
    ]
    weaker = companions.weaker(np.array(ratios))
    change = companions.reference.at(work) - weaker.at(work)
    return np.asarray((stored / (stored + plastic)) ** 2 * change)


def grid_error(
    change: Array, unseen: Array, work: Array, points: Sequence[Point], octaves: float
) -> tuple[Array, Array]:
    """Discretisation error of COR of each point, and how much of it is due to omitted waves.

    `change` is COR minus its value on cells twice as large, at the loading work `work` (J),
    `unseen` the result of `unseen_yield`, and `octaves` `OmittedWaves.octaves`.
    """
    near = np.sqrt(_smoothed(change**2, work, _NEAR_GRID))
    band = _BAND * octaves * near
    floor = np.array([_floor(point) for point in points])
    return np.sqrt(near**2 + band**2 + unseen**2 + floor**2), band


def error_of_law(scales: ScaleCurves, companions: Companions, points: Sequence[Point]) -> Array:
    """Error of COR of `points` due to the law of patches (docs/two-scales.md)."""
    work, real = array(points, "loading_work"), array(points, "contact_area")
    nominal = array(points, "contact_nodes") * companions.cell_area
    by_law = scales.error(lambda curve: curve.at(work), nominal)
    return np.asarray(np.hypot(by_law, scales.separation_error(work, real)))


def law_error(change: Array, by_law: Array, work: Array, ratio: Array) -> Array:
    """Discretisation error of COR of each point of a contact whose waves are in patches.

    No wave is left out, and the law is smooth, so few nodes are enough (docs/two-scales.md).
    `by_law` is the result of `error_of_law`, and `ratio` that of `ScaleCurves.split_ratio`; for the
    others see `grid_error`.
    """
    near = ratio**2 * _smoothed((change / ratio) ** 2, work, _NEAR_SURFACE)
    return np.asarray(np.sqrt(near + by_law**2))


def widened_error(
    error: float, last_change: float, unseen: float, point: Point, octaves: float
) -> tuple[float, float]:
    """Widen `error`, the discretisation error of COR from a convergence study.

    `last_change` is the difference of COR between the last two grids; see `grid_error`. Returns the
    sum and the error due to the waves left out.
    """
    band = _BAND * octaves * last_change
    return math.hypot(error, band, unseen, _floor(point)), band


def scatter(restitution: Array, work: Array) -> Array:
    """Error of COR if one surface represents the mean of all surfaces of its kind.

    The difference from the mean of `restitution`, plus half the width of the 95 % confidence
    interval of this mean. `restitution` has a row for each surface, that of the run first, and a
    column for each value of `work` (J); NaN if a curve is missing.
    """
    known = restitution[np.isfinite(restitution).all(axis=1)]
    if len(known) < 2:
        return np.full(work.size, math.nan)
    deviation = np.sqrt(_smoothed(np.var(known, axis=0, ddof=1), work, _NEAR_SURFACE))
    half = half_interval(len(known)) * deviation
    return np.asarray(np.abs(restitution[0] - known.mean(axis=0)) + half)


def spread_errors(
    companions: Companions,
    work: Array,
    progress: Say = ignore,
    *,
    scattered: bool = True,
    parts: list[MaterialPart] | None = None,
) -> dict[str, Array]:
    """`surface_scatter` and `material_error` of COR at `work` (J), as far as the case has them.

    `surface_scatter` includes the uncertainty of a joined spectrum of scans.
    The contributions of the library values are appended to `parts`.
    """
    case = companions.case
    columns = {}
    if case.roughness and scattered:
        others = [curve.at(work) for curve in companions.others(progress)]
        columns["surface_scatter"] = scatter(
            np.array([companions.reference.at(work), *others]), work
        )
    if spectra := companions.spectra(progress):
        own = companions.reference.at(work)
        changes = [np.abs(curve.at(work) - own) for curve in spectra]
        known = columns.get("surface_scatter", np.zeros(work.size))
        columns["surface_scatter"] = np.hypot(known, np.max(changes, axis=0))
    if case.has_library_values():
        progress("error: materials")
        changes = companions.materials(work)
        columns["material_error"] = np.sqrt(sum((c**2 for c in changes), np.zeros(work.size)))
        if parts is not None:
            parts += material_parts(companions, work)
    return columns


class ErrorBudget:
    """Adds the errors due to grid, surface and materials, and their total, to points of a run.

    Points without an impact stay unchanged. The total error of a point is set only if all of its
    parts are known. `points` has the errors so far, and `band` the errors due to waves that the
    grid leaves out, one for each impact. `parts` receives the contributions of library values.
    Without `scattered`, the scatter between surfaces is left out.
    """

    def __init__(
        self,
        case: Case,
        folder: Path,
        points: Sequence[Point],
        progress: Say = ignore,
        parts: list[MaterialPart] | None = None,
        *,
        scattered: bool = True,
    ) -> None:
        self.points, self.band, self.parts = list(points), list[float](), parts
        self._case, self._folder, self._progress = case, folder, progress
        self._scattered = scattered
        self._companions: dict[int, Companions] = {}

    @property
    def finest(self) -> Companions:
        return self._companions[max(self._companions)]

    def add(self, surface: Surface) -> None:
        """Compute the errors; `surface` is the surface on the grid of the largest depth."""
        reached = [k for k, point in enumerate(self.points) if point.loading_work > 0]
        for factor in dict.fromkeys(int(self.points[k].refine) for k in reached):
            level = [k for k in reached if self.points[k].refine == factor]
            own = self._case.grid.factor == factor
            case = self._case if own else self._case.refined(factor)
            known = [self.points[k] for k in level]
            companions = Companions.of(case, self._folder, known)
            on = surface if own else case.surface(self._folder)
            for k, point in zip(level, self._with_errors(companions, on, known), strict=True):
                self.points[k] = point
            self._companions[factor] = companions

    def _with_errors(
        self, companions: Companions, surface: Surface, points: Sequence[Point]
    ) -> list[Point]:
        work, waves = array(points, "loading_work"), OmittedWaves.of(surface)
        self._progress("error: cells twice as large")
        change = array(points, "restitution") - companions.own.at(work)
        if scales := companions.scales(self._progress):
            by_law = error_of_law(scales, companions, points)
            ratio = scales.split_ratio(array(points, "contact_area"))
            errors, band = law_error(change, by_law, work, ratio), np.zeros(work.size)
        else:
            unseen = unseen_yield(companions, waves, points)
            errors, band = grid_error(change, unseen, work, points, waves.octaves)
        columns = {"discretisation_error": errors} | spread_errors(
            companions, work, self._progress, scattered=self._scattered, parts=self.parts
        )
        columns = with_sticking(columns, companions, points, scattered=self._scattered)
        self.band += band.tolist()
        new = []
        for k, point in enumerate(points):
            own: dict[str, Any] = {name: float(of[k]) for name, of in columns.items()}
            resolved = point.resolved and not band[k] > MISSING_BAND
            point = replace(point, **own, resolved=resolved)
            if all(math.isfinite(error) for error in own.values()):
                point = replace(point, total_error=point.combined_error)
            new.append(point)
        return with_pull_off_errors(companions, new, scattered=self._scattered)


def band_warning(surface: Surface, band_errors: Sequence[float], refine: int = 1) -> Iterator[str]:
    """Yield a warning if a change of COR due to omitted waves exceeds `MISSING_BAND`.

    `refine` is the factor by which the cells of `surface` are refined.
    """
    lacking = [error for error in band_errors if error > MISSING_BAND]
    if not lacking:
        return
    band = OmittedWaves.of(surface)
    nodes = [math.ceil(edge / band.pixel) for edge in surface.grid.size]
    factor = refine * divisions(max(surface.grid.spacing), band.pixel)
    remedy = (
        "such a grid is too large, so use a smaller area, or only the larger depths"
        if nodes[0] * nodes[1] > MOST_AFFORDABLE
        else f"set grid.refine = {factor}, or use a smaller grid.spacing"
    )
    yield (
        f"the grid leaves out waves of the scan with {band.removed_slope:.0%} of its rms slope, "
        f"and {len(lacking)} of {len(band_errors)} depths are not resolved because of this (COR "
        f"may be off by {max(lacking):.2g}): cells of {1e6 * band.pixel:.3g} um ({nodes[0]} x "
        f"{nodes[1]} nodes) would resolve these waves; {remedy}"
    )


def total_error_summary(
    case: Case, points: Sequence[Point], parts: Sequence[MaterialPart] = ()
) -> dict[str, object]:
    known = largest(points, "total_error")
    values = as_rows(parts)
    return {
        "largest_total_error": known,
        "largest_model_error": largest(points, "model_error"),
        "total_error_includes": ", ".join(included(case)) if known is not None else "",
        "total_error_does_not_include": NOT_INCLUDED,
        **({"material_errors": values, "material_advice": advice(values)} if values else {}),
    }


def interrupted_errors(case: Case, points: Sequence[Point], status: str) -> Iterator[str]:
    """Yield a warning if points lack their total error because the run was interrupted."""
    missing = sum(math.isnan(point.total_error) for point in points)
    if case.total_error and status == "interrupted" and missing:
        yield (
            f"total_error is missing at {missing} of {counted(len(points), 'depth')}, because the "
            "run was stopped before it was computed; run the case again into a new folder"
        )


def included(case: Case) -> list[str]:
    """List the parts of the total error of a curve of `case`, in words."""
    words = ["solver", "grid"]
    if any(part.kind in ("measured", "joined") for part in case.roughness):
        words.append("waves of the scan that the grid leaves out")
    if any(part.kind == "joined" for part in case.roughness):
        words.append("uncertainty of the joined spectrum")
    if case.roughness:
        n = case.realisations
        words.append(
            f"95 % interval of the mean of {n} surfaces"
            if n > 1
            else f"difference of this surface from the mean of {SURFACES + 1} surfaces"
        )
    if case.has_library_values():
        words.append("spread of the library's materials")
    return words


def steps(case: Case) -> int:
    """Number of calls of `progress` during the error estimate of a run or ensemble of `case`."""
    if not case.total_error:
        return 0
    surfaces = SURFACES if case.roughness and case.realisations == 1 else 0
    joined = any(part.kind == "joined" for part in case.roughness)
    return 1 + surfaces + int(joined) + int(case.has_library_values())


def usual_grid_error(point: Point) -> float:
    """Error of COR that 90 % of contacts with as many nodes in the median patch do not exceed."""
    nodes = math.log(max(point.median_patch_nodes, 1.0))
    return math.exp(np.interp(nodes, np.log(_PATCH_NODES), np.log(_PATCH_ERROR)))


def _floor(point: Point) -> float:
    """Minimum discretisation error: the usual error for this number of nodes, times `_SHARE`."""
    nodes = max(point.median_patch_nodes, 1.0)
    return usual_grid_error(point) * float(np.interp(nodes, _FEW_NODES, _SHARE))


def _smoothed(values: Array, work: Array, near: float) -> Array:
    """Weighted mean with the weights exp(−Δ/near), Δ the difference of ln(work)."""
    L = np.log(work)
    weights = np.exp(-np.abs(L[:, None] - L) / near)
    return np.asarray(weights @ values / weights.sum(axis=1))
