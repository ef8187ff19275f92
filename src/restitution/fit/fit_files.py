"""Write a fit as files: `fit.json` (all results), `fit.csv` (points) and the fitted `case.toml`."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import tomli_w

from restitution.case.case_file import parse_case, parse_toml, read_case
from restitution.contact.plasticity.cavity import FULL_CONSTRAINT
from restitution.fit.findings import combination, findings, identifiable
from restitution.fit.fit import Fit
from restitution.fit.indents import DEPTH, HARDNESS, SizeEffect
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


def write_fit(fit: Fit, text: str, out: Path) -> list[Path]:
    """Write the files of a fit into `out`; `text` is the case file with the first guesses."""
    case = fitted_case(fit, out)
    with hold_signals():
        write_json(out / "fit.json", _summary(fit, text))
        write_table(out / "fit.csv", fit_rows(fit))
        replace_file(out / "case.toml", lambda to: to.write_text(case, encoding="utf-8"))
        write_checksums(out, _NAMES)
    return [out / name for name in _NAMES]


def keys_of(fit: SizeEffect) -> list[str]:
    """The keys of `[interface]` that a fitted size effect sets."""
    pressure, length = f"{1e-9 * fit.hardness:.4g} GPa", f"{1e6 * fit.length:.4g} um"
    return [f'yield_pressure = "{pressure}"', f'size_effect = "{length}"']


def write_size_effect(fit: SizeEffect, out: Path, case: Path | None = None) -> list[Path]:
    """Write a fitted size effect into `out`, also into a copy of the file `case`."""
    text = None if case is None else _with_size_effect(fit, case, out)
    names = ["fit.json", "fit.csv"]
    rows = [
        {DEPTH: 1e9 * h, HARDNESS: 1e-9 * H, "fitted_hardness_GPa": 1e-9 * of, "residual": r}
        for h, H, of, r in zip(
            fit.indents.depth.tolist(),
            fit.indents.hardness.tolist(),
            fit.at(fit.indents.depth).tolist(),
            fit.residuals.tolist(),
            strict=True,
        )
    ]
    with hold_signals():
        write_json(out / "fit.json", fit.summary() | {"versions": versions()})
        write_table(out / "fit.csv", rows)
        if text is not None:
            replace_file(out / "case.toml", lambda to: to.write_text(text, encoding="utf-8"))
            names.append("case.toml")
        write_checksums(out, tuple(names))
    return [out / name for name in names]


def _with_size_effect(fit: SizeEffect, case: Path, out: Path) -> str:
    _, text = read_case(case)
    content = parse_toml(text)
    for part in _roughness(content):
        _move_scans(part, case.parent, out)
    interface = content.setdefault("interface", {})
    grows = parse_case(text).yielding().plasticity == "expanding-cavity"
    for key in ("yield_pressure", "hardness_depth"):
        interface.pop(key, None)
    key, strength = "yield_pressure", fit.hardness
    if grows:
        key, strength = "yield_strength", fit.hardness / FULL_CONSTRAINT
    interface |= {key: f"{strength:.6g} Pa", "size_effect": f"{fit.length:.6g} m"}
    return tomli_w.dumps(content)


def fitted_case(fit: Fit, out: Path) -> str:
    content = parse_toml(fit.model.text(fit.x, velocities_to_run(fit.measured.velocity), _DIGITS))
    for part in _roughness(content):
        part["realisations"] = fit.model.surfaces
        _move_scans(part, fit.model.folder, out)
    return tomli_w.dumps(content)


def _roughness(content: dict[str, Any]) -> list[dict[str, Any]]:
    rough = content.get("roughness", [])
    return rough if isinstance(rough, list) else [rough]


def _move_scans(part: dict[str, Any], folder: Path, out: Path) -> None:
    for table in (part, *part.get("scan", ())):
        if "file" in table:
            table["file"] = _moved(folder, table["file"], out)
    if "scans" in part:
        part["scans"] = [_moved(folder, name, out) for name in part["scans"]]


def _moved(folder: Path, name: str, out: Path) -> str:
    return Path(os.path.relpath(folder / name, out)).as_posix()


def fit_rows(fit: Fit) -> list[dict[str, float | str]]:
    measured, by = fit.measured, fit.deviations
    scatter = (by.by_surface**2).sum(axis=0) ** 0.5
    given = measured.deviation
    return [
        {
            VELOCITY: float(V),
            RESTITUTION: float(measured.restitution[k]),
            **({} if given is None else {DEVIATIONS[0]: float(given[k])}),
            "fitted_restitution": float(fit.fitted[k]),
            "residual": float(fit.residuals[k]),
            "weight_std": float(fit.weights[k]),
            "surface_scatter": float(scatter[k]),
            "grid_error": math.nan if by.grid is None else abs(float(by.grid[k])),
            "model_error": float(by.model[k]),
            "resolved": bool(fit.resolved[k]),
        }
        for k, V in enumerate(measured.velocity)
    ]


def _summary(fit: Fit, text: str) -> dict[str, Any]:
    known = combination(fit)
    return {
        "parameters": [_parameter(fit, k) for k in range(fit.x.size)],
        "correlation": fit.uncertainty.correlation.tolist(),
        "best_known_combination": known
        and {"exponents": known[0], "half_interval_of_logarithm": known[1]},
        "confidence": CONFIDENCE,
        "points": fit.measured.velocity.size,
        "degrees_of_freedom": fit.freedom,
        "chi_squared": fit.chi_squared,
        "rms_residual": float((fit.residuals**2).mean() ** 0.5),
        "weights": "noise, scatter between surfaces and error of the grid, in quadrature",
        "surfaces": fit.model.surfaces,
        "intervals_include": _included(fit),
        "measured_values_are": f"means over {fit.model.surfaces} places of impact or more; "
        "std_if_one_place assumes one place",
        "low_and_high_include": "intervals_include, and the model of plasticity "
        f"({fit.deviations.model_share:g} times by_model_error)",
        "intervals_do_not_include": "values that the case gives, rate effects of yielding",
        "largest_model_error": float(fit.deviations.model.max()),
        "searches": [
            {
                "factors": [math.exp(x) for x in minimum.x.tolist()],
                "sum_of_squares": minimum.squares,
            }
            for minimum in fit.minima
        ],
        "curves_computed": fit.model.evaluations,
        "findings": findings(fit),
        "case": text,
        "versions": versions(),
    }


def _parameter(fit: Fit, k: int) -> dict[str, Any]:
    parameter, factor = fit.parameters[k], fit.factors[k]
    uncertainty, value = fit.uncertainty, parameter.value * factor
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
        "identifiable": identifiable(fit, k),
        "relative_std": {
            part: _known(fit.uncertainty.deviation(part)[k]) for part in fit.uncertainty.parts
        },
        "by_model_error": _known(fit.uncertainty.by_model[k]),
        "std_if_one_place": _known(fit.uncertainty.by_one_place[k]),
    }


def _interval(value: float, half: float) -> tuple[float | None, float | None]:
    if not math.isfinite(half):
        return None, None
    return value * math.exp(-half), value * math.exp(half)


def _known(value: float) -> float | None:
    """`value` of a logarithm, or None if it is so large that it counts as unknown."""
    return float(value) if value < math.log(1e6) else None


def _included(fit: Fit) -> str:
    scattered = "standard deviations" if fit.measured.deviation is not None else "residuals"
    words = [f"noise (from the {scattered})", "solver"]
    if fit.model.surfaces > 1:
        words.append(f"mean of {fit.model.surfaces} surfaces")
    if fit.deviations.grid is not None:
        words.append("grid")
    return ", ".join(words)
