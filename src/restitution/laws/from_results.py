"""Make a restitution law from the stored results of a run, ensemble or convergence study."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from pydantic import ValidationError

from restitution.case.bodies import BodyTable
from restitution.curve.point import Point as Impact
from restitution.errors import CaseError, OutputError, first_problem, one_line
from restitution.laws.coverage import covered_points
from restitution.laws.law import Conventions, Law, LawPoint
from restitution.laws.law_files import LAW_FILE
from restitution.laws.particle import Particle
from restitution.losses.losses import NAMES
from restitution.results.reader import RunResults, read_run

_SAME = 1e-9  # largest relative difference of values that count as equal


def bare_law(out: Path | RunResults) -> Law:
    """Make the law of the results `out`, or of those in this folder, without fits.

    The law of an ensemble holds means over its surfaces; its errors include the confidence interval
    of the mean, and those of a convergence study the error of the grid. Depths without impact
    velocity are left out. Raises `OutputError` and `CaseError`.
    """
    run = out if isinstance(out, RunResults) else _read(out)
    out = run.folder or Path("the results")
    try:
        return _law(out, run)
    except ValidationError as error:
        raise _inconsistent(out, first_problem(error)) from None
    except (KeyError, TypeError) as error:
        raise _inconsistent(out, f"{type(error).__name__}: {error}") from None


def _inconsistent(out: Path, why: str) -> OutputError:
    return OutputError(
        f"{out}: its files do not belong together ({one_line(why)}); run the case again"
    )


def _law(out: Path, run: RunResults) -> Law:
    curve, summary, case = run.curve, run.summary, run.case
    derived, model = summary["derived"], summary["model"]
    if derived.get("reduced_mass_kg") is None:
        raise CaseError(
            f"{out}: has no impact velocities, because its case gives no density; give "
            "first.density (and second.density) and run the case again"
        )
    points = _points(run)
    if not points:
        raise CaseError(
            f"{out}: none of the stored depths is the maximum indentation of an impact, because "
            "the bodies do not touch or adhesion alone pulls them deeper; add deeper indentations"
        )
    warnings = list(summary["warnings"])
    if summary["status"] != "complete":
        warnings.insert(0, f"the run is not complete ({summary['status']}: {summary['reason']})")
    if case.interface.adhesive_energy > 0 and case.unloading.method == "energy-estimate":
        warnings.append(
            'COR is an estimate (unloading.method = "energy-estimate"), and pull-off is not known'
        )
    depths = len(curve.points)
    if left := depths - len(points):
        warnings.append(
            f"{left} of {depths} depths are left out: no impact has its maximum indentation "
            "there, because adhesion alone pulls the bodies deeper or the bodies do not touch"
        )
    if unknown := sum(_is_unknown(point, wanted=case.total_error) for point in curve.points):
        warnings.append(
            f"the total error is unknown at {unknown} of {depths} depths; the error stated "
            "there is the largest possible one, the larger of COR and 1 - COR"
        )
    pair = case.pair()
    for name, value in (
        ("reduced_radius_m", pair.radius),
        ("reduced_mass_kg", pair.mass),
        ("contact_modulus_Pa", pair.contact_modulus),
    ):
        if value is None or not math.isclose(derived[name], value, rel_tol=_SAME):
            raise OutputError(
                f"{out}: {name} in summary.json differs from the case in results.nc, so a file "
                "is damaged; run the case again"
            )
    law = Law(
        title=case.title,
        first=_particle("first", case.first),
        second=_particle("second", case.second) if case.second else _particle("first", case.first),
        radius=pair.radius,
        contact_modulus=pair.contact_modulus,
        mass=derived["reduced_mass_kg"],
        yield_pressure=derived["yield_pressure_Pa"],
        work_of_adhesion=case.interface.adhesive_energy,
        friction=case.interface.friction,
        model={key: str(value) for key, value in model.items()},
        conventions=Conventions(
            **summary["conventions"],
            restitution_error=_error_includes(summary["diagnostics"], wanted=case.total_error),
        ),
        yield_velocity=derived["yield_velocity_m_per_s"],
        smooth_sticking_velocity=derived.get("sticking_velocity_m_per_s"),
        sticks_below=None,
        points=tuple(points),
        run_in=covered_points(run.run_in),
        warnings=tuple(warnings),
        case=run.case_text,
        versions=summary["versions"],
    )
    if law.sticks_everywhere:
        warnings.append(
            f"the pair sticks at every computed velocity (up to {law.highest:.4g} m/s); it may "
            "rebound at higher velocities"
        )
    sticking = summary.get("sticking", {})
    return replace(
        law,
        conventions=_with_losses(law),
        sticks_below=law.curve().begins() or sticking.get("sticks_below_m_per_s") or None,
        sticks_below_error=sticking.get("sticks_below_error_m_per_s"),
        warnings=tuple(warnings),
    )


def _with_losses(law: Law) -> Conventions:
    if not law.losses:
        return law.conventions
    more = f", times the factors of {', '.join(law.losses)}"
    return replace(law.conventions, restitution=law.conventions.restitution + more)


def _read(out: Path) -> RunResults:
    if (out / "study.toml").is_file():
        raise OutputError(
            f"{out}: is a study of many cases, but a law describes one pair; run one case with "
            "`restitution run` and give its folder"
        )
    if (out / LAW_FILE).is_file():
        raise OutputError(f"{out}: is already a law; give the folder of a run")
    if (out / "curve.csv").is_file() and not (out / "summary.json").exists():
        raise OutputError(
            f"{out}: this run has not ended, or was killed; wait for it, or run the case again"
        )
    if not (out / "curve.csv").is_file() and not (out / "results.nc").is_file():
        raise OutputError(
            f"{out}: holds no results of a run; give the folder that `restitution run` wrote"
        )
    run = read_run(out)
    run.check()
    return run


def _error_includes(diagnostics: Mapping[str, object], *, wanted: bool) -> str:
    includes = diagnostics.get("total_error_includes")
    if not includes and wanted:
        return "everything, because it is the largest possible error of COR"
    includes = includes or "solver"
    excludes = diagnostics.get("total_error_does_not_include") or "anything else"
    model = diagnostics.get("largest_model_error")
    error = f"; model_error is up to {model:.2g}" if isinstance(model, float) else ""
    return f"{includes}; not: {excludes}{error}"


def _points(run: RunResults) -> list[LawPoint]:
    points: list[LawPoint] = []
    for impact in run.curve.impacts.points:
        velocity = impact.impact_velocity
        if not velocity > 0 or (points and velocity <= points[-1].velocity):
            continue
        points.append(
            LawPoint(
                velocity=velocity,
                restitution=impact.final,
                error=_error(impact, wanted=run.case.total_error),
                ratio=impact.final_ratio,
                loading_work=impact.loading_work,
                indentation=impact.indentation,
                force=impact.force,
                pull_off_force=_known(impact.pull_off_force),
                pull_off_error=_known(impact.pull_off_error),
                separation=_known(impact.separation_indentation),
                resolved=impact.resolved,
                quasi_static=impact.restitution,
                factors=_factors(impact),
                loss_error=_known(impact.loss_error),
            )
        )
    return points


def _factors(impact: Impact) -> dict[str, float]:
    factors = {name: getattr(impact, f"{name}_factor") for name in NAMES}
    return {name: of for name, of in factors.items() if not math.isnan(of)}


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value


def _error(point: Impact, *, wanted: bool) -> float:
    """Total error of a point: the largest possible error of COR if it is `wanted` but unknown."""
    e = point.final
    if _is_unknown(point, wanted=wanted):
        return max(e, 1 - e)
    error = point.combined_error if math.isnan(point.total_error) else point.total_error
    product = e / point.restitution if point.restitution > 0 else 1.0
    beyond = 0.0 if math.isnan(point.loss_error) else point.loss_error
    return min(product * error + beyond, max(e, 1 - e))


def _is_unknown(point: Impact, *, wanted: bool) -> bool:
    return wanted and math.isnan(point.total_error)


def _particle(name: str, body: BodyTable) -> Particle:
    return Particle(
        name=body.material or name,
        radius=_rounded(body.radius),
        youngs_modulus=body.youngs_modulus,
        poissons_ratio=body.poissons_ratio,
        density=body.density,
        yield_strength=body.yield_strength,
        hardness=body.hardness,
    )


def _rounded(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.12g}")
