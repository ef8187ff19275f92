"""The claims of Ghanbarzadeh et al. (2019) on each figure, compared with the bundled studies."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import linregress

from restitution.sweeps.sweep import AS_WRITTEN
from restitution.theory import JKR, Hertz, ThorntonNing

Array = NDArray[np.float64]
Studies = Mapping[str, xr.Dataset]
Verdict = Literal["agrees", "agrees in part", "does not agree", "not decided"]

# Values of the two steel spheres of the paper: reduced radius R* (m), contact modulus E* (Pa),
# yield pressure p_y (Pa) and radius of each sphere (m). The name R stands for the reduced radius
# here. In the claims of the paper, R is understood as the radius of each sphere (RADIUS).
R, E_STAR, P_Y, RADIUS = 250e-6, 112e9, 750e6, 500e-6
SMOOTH = "1 pm"  # rms roughness of cases that represent the smooth sphere
_VARIABLES = ("indentation", "restitution", "force", "pull_off_force", "resolved")
_NEAR = 0.05  # largest relative difference at which COR counts as that of the smooth sphere


@dataclass(frozen=True)
class Judgement:
    """A claim of the paper, what the results say (`result`), and the number that decides."""

    figure: str
    claim: str
    result: str
    number: float
    verdict: Verdict
    resolved: str


@dataclass(frozen=True)
class CaseCurve:
    """One case of a study, with the depths that it reached."""

    label: str
    depth: Array
    cor: Array
    force: Array
    pull_off: Array
    resolved: NDArray[np.bool_]


def curves(study: xr.Dataset) -> list[CaseCurve]:
    dims = [str(dim) for dim in study["restitution"].dims if dim != "depth"]
    stacked = study.stack(_case=dims).transpose("_case", "depth", ...)
    keys = [str(key) for key in study.coords if key != "case" and "depth" not in study[key].dims]
    result = []
    for k in np.flatnonzero(stacked["status"].values == "complete"):
        case = stacked.isel(_case=k)
        label = ", ".join(_as_written(study[key])[case[key].item()] for key in keys)
        have = np.isfinite(case["indentation"].values)
        depth, cor, force, pull_off, resolved = (case[name].values[have] for name in _VARIABLES)
        result.append(CaseCurve(label, depth, cor, force, pull_off, resolved.astype(bool)))
    return result


def _as_written(coordinate: xr.DataArray) -> dict[float | str, str]:
    values = coordinate.values.tolist()
    # Files of earlier versions lack this attribute, because they stored the values as texts.
    written = coordinate.attrs.get(AS_WRITTEN)
    return dict(
        zip(values, map(str, values) if written is None else json.loads(written), strict=True)
    )


def rough_and_smooth(study: xr.Dataset) -> tuple[list[CaseCurve], CaseCurve]:
    cases = curves(study)
    smooth = next(curve for curve in cases if curve.label.startswith(SMOOTH))
    return [curve for curve in cases if not curve.label.startswith(SMOOTH)], smooth


def _resolved(*of: CaseCurve) -> str:
    return _count(np.concatenate([curve.resolved for curve in of]))


def _count(flags: NDArray[np.bool_]) -> str:
    return f"{np.count_nonzero(flags)} of {flags.size}"


def _verdict(agrees: bool, in_part: bool = False) -> Verdict:
    if agrees:
        return "agrees"
    return "agrees in part" if in_part else "does not agree"


def _figure_5(studies: Studies) -> Judgement:
    (curve,) = curves(studies["hertz"])
    off = float(np.abs(curve.force / Hertz(R, E_STAR).force(curve.depth) - 1).max())
    return Judgement(
        "5",
        "The elastic solution agrees with Hertz's.",
        f"The force is within {off:.2%} of Hertz's at all depths.",
        off,
        _verdict(off < 0.01),
        _resolved(curve),
    )


def _figure_6(studies: Studies) -> Judgement:
    off = {}
    smooth = ThorntonNing(R, E_STAR, P_Y)
    yielded = 2 * float(smooth.first_yield.indentation)
    cases = curves(studies["thornton-ning"])
    for curve in cases:
        deep = curve.depth > yielded
        law = smooth.loading_force(curve.depth[deep])
        off[curve.label] = float(np.max(np.abs(curve.force[deep] / law - 1)))
    return Judgement(
        "6",
        "Loading and unloading with a yield cut-off agree with Thornton and Ning (1998).",
        "With the pressure truncated at p_y as in their theory, the loading force is within "
        f"{off['truncated']:.1%} of theirs. With pressure and surface in equilibrium, as in the "
        f"other figures, the force is up to {off['equilibrium']:.0%} larger. The reason is "
        "the model, not the accuracy of the solution.",
        off["truncated"],
        _verdict(off["truncated"] < 0.02),
        _resolved(*cases),
    )


def _figure_7(studies: Studies) -> Judgement:
    (curve,) = curves(studies["jkr"])
    jkr = JKR(R, E_STAR, 0.09)
    loading = float(np.abs(curve.force / jkr.force(curve.depth) - 1).max())
    off = np.abs(curve.pull_off / jkr.pull_off_force - 1)
    worst, deepest = max(loading, float(off.max())), float(off[-1])
    return Judgement(
        "7",
        "Adhesive elastic contact agrees with the JKR theory.",
        f"The force in loading is within {loading:.1%} of the JKR force. The pull-off force is "
        f"within {deepest:.1%} of 3/2 π w R* after the deepest indentation, and within "
        f"{off.max():.1%} after every indentation. After shallow indentations, the small unloading "
        "steps resolve the largest force jumps that the grid causes.",
        worst,
        _verdict(worst < 0.05, max(loading, deepest) < 0.05),
        _resolved(curve),
    )


def _figure_8(studies: Studies) -> Judgement:
    cases = curves(studies["smooth-yield"])
    tops = [int(curve.cor.argmax()) for curve in cases]
    inside = [0 < top < curve.cor.size - 1 for top, curve in zip(tops, cases, strict=True)]
    where = ", ".join(
        f"{curve.label}: {curve.cor[top]:.3f} at {1e9 * curve.depth[top]:.3g} nm"
        for top, curve in zip(tops, cases, strict=True)
    )
    return Judgement(
        "8",
        "For both yield stresses COR first increases with indentation and then reduces.",
        f"COR is largest between the ends of the curve in {sum(inside)} of {len(inside)} cases "
        f"({where}).",
        sum(inside) / len(inside),
        _verdict(all(inside), any(inside)),
        _resolved(*cases),
    )


def _figure_9(studies: Studies) -> Judgement:
    cases = curves(studies["smooth-energy"])
    cor = np.array([curve.cor for curve in cases])
    spread = np.ptp(cor, axis=0)
    deep = cases[0].depth > 100e-9
    shallow, left = float(spread.max()), float(spread[deep].max())
    return Judgement(
        "9",
        "For smooth spheres interface energy affects COR at small indentations only.",
        f"COR differs between the energies by up to {shallow:.2f} over all depths, and by up to "
        f"{left:.3f} beyond 100 nm.",
        left,
        _verdict(left < 0.05 < shallow),
        _resolved(*cases),
    )


def _stages(studies: Studies) -> Judgement:
    rough, _ = rough_and_smooth(studies["roughness"])
    complete = []
    for curve in rough:
        low = int(curve.cor[:-1].argmin())
        high = low + int(curve.cor[low:].argmax())
        rises = curve.cor[high] > curve.cor[low] + 0.02
        complete.append(low > 0 and rises and high < curve.cor.size - 1)
    names = ", ".join(c.label for c, whole in zip(rough, complete, strict=True) if whole) or "none"
    return Judgement(
        "10",
        "COR of rough spheres has three stages: it falls as asperities yield, rises as the "
        "bulk takes over, and falls as the bulk yields.",
        f"All three stages occur within the computed depths for Rq = {names} ({sum(complete)} "
        f"of {len(complete)}). The rougher the surface, the deeper the last stage begins.",
        sum(complete) / len(complete),
        _verdict(all(complete), any(complete)),
        _resolved(*rough),
    )


def _shallow_merging(studies: Studies) -> Judgement:
    rough, smooth = rough_and_smooth(studies["roughness"])
    # Skip depths where the smooth sphere sticks: the relative difference is undefined.
    shallow = (smooth.depth <= 8e-9) & (smooth.cor > 0)
    off = max(float(np.abs(c.cor[shallow] / smooth.cor[shallow] - 1).max()) for c in rough)
    flags = np.concatenate([c.resolved[shallow] for c in rough])
    return Judgement(
        "10",
        "Below 8 nm COR merges with the smooth sphere's, for every roughness.",
        f"Up to 8 nm, COR differs by up to {off:.0%} from the smooth sphere's."
        + _single_nodes(flags),
        off,
        _verdict(off < _NEAR),
        _count(flags),
    )


def _shallow_trend(studies: Studies) -> Judgement:
    rough, smooth = rough_and_smooth(studies["roughness"])
    shallow = (smooth.depth >= 8e-9) & (smooth.depth <= 50e-9)
    cor = np.array([curve.cor[shallow] for curve in rough])
    off = float((np.ptp(cor, axis=0) / cor.mean(axis=0)).max())
    flags = np.concatenate([c.resolved[shallow] for c in rough])
    return Judgement(
        "10",
        "Below 50 nm COR follows the same trend for every roughness.",
        f"Between 8 and 50 nm, COR differs between roughnesses by up to {off:.0%} of its mean."
        + _single_nodes(flags),
        off,
        _verdict(off < 0.1),
        _count(flags),
    )


def _single_nodes(flags: NDArray[np.bool_]) -> str:
    if np.mean(flags) > 0.5:
        return ""
    return (
        " Most of these contacts have only a few nodes. Their yielding depends on the cell size "
        "and not on the surface, so a common trend would be an effect of the grid "
        "(docs/resolution.md)."
    )


def critical_indentation(curve: CaseCurve, smooth: CaseCurve) -> float:
    """Depth (m) beyond which COR differs by at most 5 % from the smooth sphere; NaN if not reached.

    The difference is interpolated linearly in the logarithm of depth.
    """
    off = np.abs(curve.cor / smooth.cor - 1)
    apart = np.flatnonzero(off > _NEAR)
    if apart.size == 0:
        return float(curve.depth[0])
    last = int(apart[-1])
    if last == off.size - 1:
        return math.nan
    share = (off[last] - _NEAR) / (off[last] - off[last + 1])
    return float(curve.depth[last] * (curve.depth[last + 1] / curve.depth[last]) ** share)


def critical_indentations(study: xr.Dataset) -> dict[str, tuple[float, float]]:
    """Return Rq/RADIUS and the critical indentation (m) of each rough case of a study, by label."""
    rough, smooth = rough_and_smooth(study)
    return {
        curve.label: (
            1e-6 * float(curve.label.split()[0]) / RADIUS,
            critical_indentation(curve, smooth),
        )
        for curve in rough
    }


def _figure_11(studies: Studies) -> Judgement:

    indentations = critical_indentations(studies["critical"])
    resolved = _resolved(*curves(studies["critical"]))
    reached = np.array([pair for pair in indentations.values() if not math.isnan(pair[1])])
    count = f"{len(reached)} of {len(indentations)} surfaces"
    claim = "The critical indentation i_cr,max depends linearly on Rq/R."
    roughnesses = len(set(reached[:, 0])) if len(reached) else 0
    if roughnesses < 3:
        words = f"Reached by {count}, with {roughnesses} roughnesses: too few for a line. "
        if len(reached):
            means = ", ".join(
                f"{1e6 * reached[reached[:, 0] == ratio, 1].mean():.2g} µm at Rq/R = {ratio:.2g}"
                for ratio in sorted(set(reached[:, 0]))
            )
            words += f"Means: {means}."
        return Judgement("11", claim, words, math.nan, "not decided", resolved)
    line = linregress(reached[:, 0], reached[:, 1])
    r2 = float(line.rvalue**2)
    return Judgement(
        "11",
        claim,
        f"i_cr,max = {1e3 * line.slope:.2g} mm · Rq/R {1e6 * line.intercept:+.2g} µm with "
        f"r² = {r2:.2f}, standard error of the slope {1e3 * line.stderr:.2g} mm; reached by "
        f"{count}.",
        r2,
        _verdict(r2 > 0.9, r2 > 0.7),
        resolved,
    )


def _figure_12(studies: Studies) -> Judgement:
    rough, smooth = rough_and_smooth(studies["roughness"])
    carries = smooth.cor > 0
    most = [
        float(((smooth.cor - c.cor) / np.where(carries, smooth.cor, 1))[carries].max())
        for c in rough
    ]
    return Judgement(
        "12",
        "Rougher surfaces deviate more from the smooth one, and lose more energy.",
        "Largest (COR_smooth − COR_rough)/COR_smooth: "
        + ", ".join(f"{m:.0%} at Rq = {c.label}" for m, c in zip(most, rough, strict=True))
        + ".",
        max(most),
        _verdict(bool(np.all(np.diff(most) > -0.02)), in_part=True),
        _resolved(*rough),
    )


def _figure_13(studies: Studies) -> Judgement:
    soft, hard = sorted(curves(studies["rough-yield"]), key=lambda c: float(c.label.split()[0]))
    deep = soft.depth > 50e-9
    ratio = soft.cor / hard.cor
    beyond = float(ratio[deep].mean())
    return Judgement(
        "13",
        "Yield stress dramatically affects COR of rough spheres.",
        f"Beyond 50 nm, COR at 150 MPa is on average {beyond:.0%} of COR at 750 MPa. Below 50 nm "
        f"the ratio is {float(np.nanmin(ratio[~deep])):.0%} to "
        f"{float(np.nanmax(ratio[~deep])):.0%}, so the curves also differ there.",
        beyond,
        _verdict(beyond < 0.8),
        _resolved(soft, hard),
    )


def _figure_14(studies: Studies) -> Judgement:
    rough = curves(studies["rough-energy"])
    smooth = curves(studies["smooth-energy"])
    # Compare only depths in the range of both studies.
    depth = rough[0].depth
    depth = depth[(depth >= smooth[0].depth[0]) & (depth <= smooth[0].depth[-1])]

    def spread(of: list[CaseCurve]) -> Array:
        cor = [np.interp(np.log(depth), np.log(c.depth), c.cor) for c in (of[0], of[-1])]
        return np.asarray(np.abs(cor[0] - cor[1]))

    of_rough, of_smooth = spread(rough), spread(smooth)
    return Judgement(
        "14",
        "Interface energy has less effect on COR of rough spheres than of smooth ones.",
        f"Between 0.01 and 0.09 J/m², COR of rough spheres differs on average by "
        f"{of_rough.mean():.3f} (up to {of_rough.max():.2f}). COR of smooth spheres at the same "
        f"depths differs by {of_smooth.mean():.3f} (up to {of_smooth.max():.2f}).",
        float(of_rough.mean() / of_smooth.mean()),
        _verdict(of_rough.mean() < of_smooth.mean()),
        _resolved(*rough),
    )


CLAIMS: tuple[Callable[[Studies], Judgement], ...] = (
    _figure_5,
    _figure_6,
    _figure_7,
    _figure_8,
    _figure_9,
    _stages,
    _shallow_merging,
    _shallow_trend,
    _figure_11,
    _figure_12,
    _figure_13,
    _figure_14,
)
