"""Write a fit as files: `fit.json` (all results), `fit.csv` (points) and the fitted `case.toml`."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

from restitution.case.case_file import parse_toml
from restitution.fit.findings import combination, findings, identifiable
from restitution.fit.fit import Fit
from restitution.fit.measured import DEVIATIONS, RESTITUTION, VELOCITY
from restitution.fit.model import velocities_to_run
from restitution.fit.uncertainty import CONFIDENCE
from restitution.results.interruption import hold_signals
from restitution.results.writer import (
    replace_file,
    versions,
    write_checksums,
    write_json,
    write_table,
)

_DIGITS = 8  # number of significant digits of fitted values in the case file
_NAMES = ("fit.json", "fit.csv", "case.toml")


def write_fit(found: Fit, text: str, out: Path) -> list[Path]:
    """Write the output files of a fit into `out`; `text` is the case file with the first guesses.

    Raises `OutputError`.
    """
    case = fitted_case(found, out)
    with hold_signals():
        write_json(out / "fit.json", _summary(found, text))
        write_table(out / "fit.csv", fit_rows(found))
        replace_file(out / "case.toml", lambda to: to.write_text(case, encoding="utf-8"))
        write_checksums(out, _NAMES)
    return [out / name for name in _NAMES]


def fitted_case(found: Fit, out: Path) -> str:
    """Return the text of the case file for `out`, with fitted values and measured velocities."""
    import tomli_w

    content = parse_toml(
        found.model.text(found.x, velocities_to_run(found.measured.velocity), _DIGITS)
    )
    rough = content.get("roughness", [])
    for part in rough if isinstance(rough, list) else [rough]:
        part["realisations"] = found.model.surfaces
        if "file" in part:
            part["file"] = Path(os.path.relpath(found.model.folder / part["file"], out)).as_posix()
    return tomli_w.dumps(content)


def fit_rows(found: Fit) -> list[dict[str, float | str]]:
    """Make a table row for each measured point."""
    measured, by = found.measured, found.deviations
    scatter = (by.by_surface**2).sum(axis=0) ** 0.5
    given = measured.deviation
    return [
        {
            VELOCITY: float(V),
            RESTITUTION: float(measured.restitution[k]),
            **({} if given is None else {DEVIATIONS[0]: float(given[k])}),
            "fitted_restitution": float(found.fitted[k]),
            "residual": float(found.residuals[k]),
            "weight_std": float(found.weights[k]),
            "surface_scatter": float(scatter[k]),
            "grid_error": math.nan if by.grid is None else abs(float(by.grid[k])),
            "model_error": float(by.model[k]),
            "resolved": bool(found.resolved[k]),
        }
        for k, V in enumerate(measured.velocity)
    ]


def _summary(found: Fit, text: str) -> dict[str, Any]:
    known = combination(found)
    return {
        "parameters": [_parameter(found, k) for k in range(found.x.size)],
        "correlation": found.uncertainty.correlation.tolist(),
        "best_known_combination": known
        and {"exponents": known[0], "half_interval_of_logarithm": known[1]},
        "confidence": CONFIDENCE,
        "points": found.measured.velocity.size,
        "degrees_of_freedom": found.freedom,
        "chi_squared": found.chi_squared,
        "rms_residual": float((found.residuals**2).mean() ** 0.5),
        "weights": "noise, scatter between surfaces and error of the grid, in quadrature",
        "surfaces": found.model.surfaces,
        "intervals_include": _included(found),
        "measured_values_are": f"means over {found.model.surfaces} places of impact or more; "
        "std_if_one_place assumes one place",
        "low_and_high_include": "intervals_include, and the model of plasticity "
        f"({found.deviations.model_share:g} times by_model_error)",
        "intervals_do_not_include": "values that the case gives, rate effects, elastic waves",
        "largest_model_error": float(found.deviations.model.max()),
        "searches": [
            {
                "factors": [math.exp(x) for x in minimum.x.tolist()],
                "sum_of_squares": minimum.squares,
            }
            for minimum in found.minima
        ],
        "curves_computed": found.model.evaluations,
        "findings": findings(found),
        "case": text,
        "versions": versions(),
    }


def _parameter(found: Fit, k: int) -> dict[str, Any]:
    parameter, factor = found.parameters[k], found.factors[k]
    uncertainty, value = found.uncertainty, parameter.value * factor
    low, high = _interval(value, uncertainty.combined_halves[k])
    data_low, data_high = _interval(value, uncertainty.halves[k])
    return {
        "key": parameter.key,
        "value": value,
        "unit": parameter.unit,
        "written": parameter.text(factor),
        "first_guess": parameter.written,
        "low": low,
        "high": high,
        "low_from_data": data_low,
        "high_from_data": data_high,
        "identifiable": identifiable(found, k),
        "relative_std": {
            part: _known(found.uncertainty.deviation(part)[k]) for part in found.uncertainty.parts
        },
        "by_model_error": _known(found.uncertainty.by_model[k]),
        "std_if_one_place": _known(found.uncertainty.by_one_place[k]),
    }


def _interval(value: float, half: float) -> tuple[float | None, float | None]:
    """The ends of an interval; None if it is unbounded. `half` is that of the logarithm."""
    if not math.isfinite(half):
        return None, None
    return value * math.exp(-half), value * math.exp(half)


def _known(value: float) -> float | None:
    """Return `value`, or None if `value` is at least ln 10⁶ and therefore counts as unknown.

    `value` is a standard deviation or a change of the logarithm of a parameter.
    """
    return float(value) if value < math.log(1e6) else None


def _included(found: Fit) -> str:
    scattered = "standard deviations" if found.measured.deviation is not None else "residuals"
    words = [f"noise (from the {scattered})", "solver"]
    if found.model.surfaces > 1:
        words.append(f"mean of {found.model.surfaces} surfaces")
    if found.deviations.grid is not None:
        words.append("grid")
    return ", ".join(words)
