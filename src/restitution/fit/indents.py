"""h* and H₀ of the size effect, from the hardness of indents of several depths."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t

from restitution.arguments import typed
from restitution.display import counted, quantity
from restitution.errors import CaseError
from restitution.fit.measured import Array, rows_of, wrong_cell
from restitution.fit.uncertainty import CONFIDENCE

DEPTH, HARDNESS, DEVIATION = "depth_nm", "hardness_GPa", "hardness_std_GPa"
_NEEDED = {DEPTH: "depths of the indents in nm", HARDNESS: "hardness in GPa"}
_RANGES = {DEPTH: (1e-1, 1e6), HARDNESS: (1e-3, 1e3), DEVIATION: (1e-9, 1e3)}
_LEAST = 4  # points
_SHALLOW = 50e-9  # depth (m) below which indents are softer than the law (docs/size-effect.md)
_UNKNOWN = math.log(4.0)  # logarithm of the ratio of the ends of an interval that is too wide


@dataclass(frozen=True)
class Indents:
    """Depths (m) of indents, their hardness (Pa) and its standard deviation (Pa; or None)."""

    depth: Array
    hardness: Array
    deviation: Array | None = None


@dataclass(frozen=True)
class SizeEffect:
    """A fit of H = H₀ √(1 + h*/h) to `indents`.

    Attributes:
        indents: The measured table.
        hardness: H₀ (Pa).
        length: h* (m).
        halves: Half-widths of the 95 % intervals of ln H₀ and ln h*.
        residuals: Logarithms of the ratios of measured to fitted hardness.
    """

    indents: Indents
    hardness: float
    length: float
    halves: tuple[float, float]
    residuals: Array

    def at(self, depth: Array) -> Array:
        """Fitted hardness (Pa) at each `depth` (m)."""
        return np.asarray(self.hardness * np.sqrt(1 + self.length / depth))

    def interval(self, name: str) -> tuple[float, float]:
        """The 95 % interval of `hardness` or `length`."""
        value, half = getattr(self, name), self.halves[name == "length"]
        return value * math.exp(-half), value * math.exp(half)

    def findings(self) -> list[str]:
        """Reasons to doubt the fit, in words."""
        said, depth = [], self.indents.depth
        if (few := int((depth < _SHALLOW).sum())) > 0:
            said.append(
                f"{few} of {counted(depth.size, 'depth')} are below {quantity(_SHALLOW, 'm')}, "
                "where the rounded tip and the nucleation of dislocations change the hardness; "
                "leave them out"
            )
        if 2 * self.halves[1] > _UNKNOWN:
            low, high = self.interval("length")
            said.append(
                f"h* is not identifiable from these data: its 95 % interval spans {low:.2g} to "
                f"{high:.2g} m; measure at depths from h*/3 to 10 h*"
            )
        return said

    def summary(self) -> dict[str, Any]:
        """The results, as in `fit.json`."""
        values = {"hardness_Pa": "hardness", "size_effect_m": "length"}
        return {
            name: dict(
                zip(("value", "low", "high"), (getattr(self, of), *self.interval(of)), strict=True)
            )
            for name, of in values.items()
        } | {
            "confidence": CONFIDENCE,
            "points": self.indents.depth.size,
            "rms_residual": float(np.sqrt(np.mean(self.residuals**2))),
            "findings": self.findings(),
        }


def is_table_of_indents(path: Path) -> bool:
    """Whether the first line of a CSV file names a column of depths or hardness."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            names = [name.strip() for name in next(csv.reader(file), [])]
    except (OSError, UnicodeDecodeError, csv.Error):
        return False
    return bool({DEPTH, HARDNESS} & set(names))


def read_indents(path: Path) -> Indents:
    """Read a table of hardness. Raises a `CaseError` that names file, line and column."""
    rows = rows_of(path, _NEEDED)
    columns = [DEPTH, HARDNESS, *([DEVIATION] if rows and DEVIATION in rows[0][1] else [])]
    points = [[_value(path, line, row, column) for column in columns] for line, row in rows]
    if len({depth for depth, *_ in points}) < _LEAST:
        raise CaseError(
            f"{path}: has fewer than {_LEAST} different depths; measure the hardness at more depths"
        )
    h, H, *std = np.array(sorted(points)).T
    return Indents(1e-9 * h, 1e9 * H, 1e9 * std[0] if std else None)


def _value(path: Path, line: int, row: dict[str, str], column: str) -> float:
    low, high = _RANGES[column]
    try:
        value = float(row[column])
    except (ValueError, TypeError):
        value = math.nan
    if not low <= value <= high:
        why = f"is not a number from {low:g} to {high:g}; check the unit"
        raise wrong_cell(path, line, column, row, why)
    return value


@typed
def fit_size_effect(indents: Indents) -> SizeEffect:
    """Fit h* and H₀ to the hardness of indents.

    Args:
        indents: Depths and hardness; without deviations, their relative noise is taken as equal.

    Returns:
        The fit.

    Raises:
        CaseError: The hardness rises with depth.

    Source:
        W. D. Nix, H. Gao, J. Mech. Phys. Solids 46 (1998) 411–425.
    """
    h, H = indents.depth, indents.hardness
    known = indents.deviation is not None
    noise = indents.deviation / H if indents.deviation is not None else np.ones(h.size)
    # H² = H₀² + H₀² h*/h is a line.
    slope, square = np.polyfit(1 / h, H**2, 1, w=1 / (noise * H**2))
    if not slope > 0:
        third = max(h.size // 3, 1)
        shallow, deep = (quantity(float(v.mean()), "Pa") for v in (H[:third], H[-third:]))
        raise CaseError(
            f"{HARDNESS}: rises with depth, from {shallow} to {deep}, and a size effect lowers it; "
            "check the columns and the calibration of the tip, or leave out the shallowest indents"
        )
    begin = [0.5 * math.log(max(square, 1e-3 * float(H.min()) ** 2)), 0.0]
    begin[1] = math.log(slope) - 2 * begin[0]

    def residuals(x: Array) -> Array:
        fitted = x[0] + 0.5 * np.log1p(math.exp(min(x[1], 60.0)) / h)
        return np.asarray((np.log(H) - fitted) / noise)

    fitted = least_squares(residuals, begin)
    freedom = h.size - 2
    unit = max(float(fitted.fun @ fitted.fun) / freedom, 1.0 if known else 0.0)
    covariance = np.linalg.pinv(fitted.jac.T @ fitted.jac) * unit
    factor = float(t.ppf(0.5 * (1 + CONFIDENCE), freedom))
    half_H, half_h = (factor * np.sqrt(np.diag(covariance))).tolist()
    H0, length = (math.exp(value) for value in fitted.x.tolist())
    return SizeEffect(indents, H0, length, (half_H, half_h), fitted.fun * noise)
