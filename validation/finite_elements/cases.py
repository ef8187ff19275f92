"""Run the reference cases and write data/*.json; finished cases and ranges are skipped.

Example:
    python cases.py                     # all cases, in order
    python cases.py smooth_0.001        # one case
    python cases.py --list
"""

from __future__ import annotations

import argparse
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import solve
from indentation import loading_work, unloading_work
from problem import Model, crest_mesh, smooth_mesh, wave_mesh

HERE = Path(__file__).parent
_E, _R = 210e9, 500e-6


@dataclass(frozen=True)
class Range:
    """Depths that are read from one mesh.

    Args:
        name: label of the mesh.
        omegas: values of δ/δ_c from which the body is unloaded.
        low: δ/δ_c from which the curve is read on this mesh; steps are fine above it.
        start: δ/δ_c of the first step.
        elements: elements over the contact radius (smooth) or over one wavelength (waves).
        coarse: relative step below `low`.
        fine: relative step above `low`.
        refinement: divisor of all element sizes.
        crests: whether only the elements near the crests of waves are fine.
    """

    name: str
    omegas: tuple[float, ...]
    low: float
    start: float
    elements: float
    coarse: float = 0.07
    fine: float = 0.035
    refinement: int = 1
    crests: bool = False


@dataclass(frozen=True)
class Case:
    """One model with its ranges and kinematics (see `indentation.Indentation`)."""

    name: str
    model: Model
    ranges: tuple[Range, ...]
    kinematics: str = "small"


def _smooth(name, ratio, nu, top, elements=80, **hardening):
    contact_modulus = _E / (1 - nu**2)
    model = Model(_E, nu, ratio * contact_modulus, radius=_R, **hardening)
    ranges = [Range("a", (2, 4, 8), 0.8, 0.8, elements)]
    if top > 128:
        ranges += [
            Range("b", (16, 32, 64), 8, 0.8, elements),
            Range("c", (128, 256, 512), 64, 0.8, elements, coarse=0.1),
        ]
    else:
        ranges += [Range("b", (16, 32, 64, 128), 8, 0.8, elements)]
    return Case(name, model, tuple(ranges))


def _waves(amplitude_um, wavelength_um, finer=1):
    model = Model(
        _E, 0.3, 1e9, radius=_R, wave_amplitude=amplitude_um * 1e-6, wavelength=wavelength_um * 1e-6
    )
    start = 0.8 * model.crest_radius / model.radius
    ranges = (
        Range("a", (0.25, 0.5, 1), start, start, 64 * finer, fine=0.05),
        Range("b", (2, 4, 8), 1, start, (32 if wavelength_um > 6 else 24) * finer, coarse=0.1),
    )
    return Case(f"waves_A{amplitude_um:g}um_L{wavelength_um:g}um", model, ranges)


def _refined(case, name, **changes):
    return replace(case, name=name, ranges=tuple(replace(r, **changes) for r in case.ranges))


def _with_kinematics(case, name, kinematics):
    return replace(case, name=name, kinematics=kinematics)


def all_cases() -> list[Case]:
    """Return all cases in the order in which they run."""
    cases = [_smooth("smooth_0.001", 0.001, 0.3, 512), _smooth("smooth_0.005", 0.005, 0.3, 128)]
    cases += [_waves(a, w) for a in (0.03, 0.1) for w in (8, 4)]
    cases += [
        _smooth("hardening_0.02E", 0.002, 0.3, 128, hardening_modulus=0.02 * _E),
        _smooth("poisson_0.2", 0.001, 0.2, 128, 60),
        _smooth("poisson_0.4", 0.001, 0.4, 128),
        _smooth("smooth_0.0005", 0.0005, 0.3, 512),
        _smooth("hardening_0.1E", 0.002, 0.3, 128, 60, hardening_modulus=0.1 * _E),
    ]
    cases += [_waves(0.01, w) for w in (8, 4)]
    cases += [
        _with_kinematics(cases[1], "finite_0.005", "finite"),
        _with_kinematics(cases[1], "flattening_0.005", "flattening"),
        _with_kinematics(cases[0], "finite_0.001", "finite"),
    ]
    # Computed after the constants of the model had been chosen on the waves above.
    cases += [_waves(a, w) for a, w in ((0.02, 6), (0.05, 6), (0.06, 10), (0.1, 12))]
    cases += [_waves(a, w, finer=2) for a, w in ((0.06, 4), (0.2, 12))]
    return cases


def check_cases() -> list[Case]:
    """Return cases for comparison and convergence; they go to data/checks."""
    by_name = {c.name: c for c in all_cases()}
    smooth = by_name["smooth_0.001"]
    wave, rough = by_name["waves_A0.03um_L8um"], by_name["waves_A0.1um_L4um"]
    result = [
        Case(f"compare_{s:g}MPa", Model(_E, 0.3, s * 1e6, radius=_R), smooth.ranges[:2])
        for s in (1000, 250)
    ]
    first = replace(smooth, ranges=smooth.ranges[:1])
    both = replace(smooth, ranges=smooth.ranges[:2])
    result += [
        _refined(both, "smooth_0.001_double_elements", elements=40),
        _refined(first, "smooth_0.001_half_steps", fine=0.0175),
        *(
            replace(
                wave,
                name=f"{wave.name}_double_elements",
                ranges=tuple(replace(r, elements=r.elements / 2) for r in wave.ranges),
            )
            for wave in (wave, by_name["waves_A0.06um_L4um"], by_name["waves_A0.2um_L12um"])
        ),
        _refined(first, "smooth_0.001_half_elements", refinement=2),
        _refined(
            replace(rough, ranges=rough.ranges[:1]), "waves_A0.1um_L4um_half_elements", elements=128
        ),
    ]
    for refinement in (1, 2):
        result += convergence_cases(refinement)
    for factor in (1, 2, 4):
        result += crest_cases(factor)
    result += [c for k in ("deformed-contact", "finite") for c in convergence_cases(1, k)]
    return result


# Depths of the waves where a model was farthest from the reference: amplitude (µm), wavelength
# (µm), δ/δ_c, and elements per wavelength on the coarsest of the meshes.
_CONVERGENCE = (
    (0.1, 8, 2, 32),
    (0.2, 12, 4, 32),
    (0.06, 4, 0.25, 64),
    (0.1, 4, 0.5, 64),
    (0.1, 4, 4, 24),
    (0.06, 10, 8, 32),
    (0.1, 12, 2, 32),
    (0.1, 12, 8, 32),
    (0.06, 4, 4, 24),
    (0.1, 8, 1, 64),
    (0.03, 4, 0.25, 64),
)


def convergence_cases(refinement: int, kinematics: str = "small") -> list[Case]:
    """Return one depth of each steep wave on meshes with all elements `refinement` times smaller.

    The gradings become finer, too, so the meshes of a depth are of one family.
    """
    found = []
    for amplitude, wavelength, omega, elements in _CONVERGENCE:
        wave = _waves(amplitude, wavelength)
        part = wave.ranges[0]
        mesh = Range(
            f"refined_{refinement}",
            (omega,),
            omega / 2,
            part.start,
            elements,
            coarse=0.1,
            fine=0.05,
            refinement=refinement,
        )
        name = f"{wave.name}_omega{omega:g}_refined_{refinement}"
        if kinematics != "small":
            name += f"_{kinematics}"
        found.append(replace(wave, name=name, ranges=(mesh,), kinematics=kinematics))
    return found


def crest_cases(factor: int) -> list[Case]:
    """Return the depths of `convergence_cases` with `factor` times smaller elements at the crests.

    The elements elsewhere are as large on all meshes of a depth.
    """
    found = []
    for case, depth in zip(convergence_cases(1), _CONVERGENCE, strict=True):
        elements = factor * depth[-1]
        mesh = replace(case.ranges[0], name=f"crests_{factor}", elements=elements, crests=True)
        name = case.name.replace("refined_1", f"crests_{factor}")
        found.append(replace(case, name=name, ranges=(mesh,)))
    return found


def run_case(case: Case, partial: Path) -> Iterator[dict]:
    """Yield the merged table of a case after each range; `partial` keeps finished ranges."""
    partial.mkdir(parents=True, exist_ok=True)
    results: list[dict] = []
    for part in case.ranges:
        file = partial / f"{case.name}_{part.name}.json"
        if not file.exists():
            mesh = wave_mesh if case.model.wave_amplitude else smooth_mesh
            if part.crests:
                mesh = crest_mesh
            spec = mesh(case.model, max(part.omegas), part.elements, part.refinement)
            force_step = 0.045 * part.fine / 0.035 if part.fine < 0.035 else 0.045
            result = solve.run_range(
                case.model,
                spec,
                part.omegas,
                part.low,
                part.start,
                part.coarse,
                part.fine,
                force_step,
                kinematics=case.kinematics,
            )
            file.write_text(json.dumps(_round(result)))
            print(
                case.name,
                part.name,
                result["mesh"]["run_time_s"],
                "s,",
                result["mesh"]["elements"],
                "elements,",
                result["mesh"]["newton_iterations"],
                "iterations",
                flush=True,
            )
        results.append(json.loads(file.read_text()))
        merged = merge(case, results)
        yield merged


def smooth_over_steps(indentation, values, window: float = 0.25) -> np.ndarray:
    """Return values > 0 smoothed by local parabolas of ln(value) over ln(indentation).

    Nodes enter the contact one by one, so force and radius alternate by a part of one element.

    Args:
        indentation: depths (m).
        values: positive values, one per depth.
        window: half width of the window in ln(indentation).
    """
    x, y, result = np.log(indentation), np.log(values), np.empty(len(values))
    for k in range(len(x)):
        # At the ends the window keeps its width.
        centre = np.clip(x[k], x[0] + window, max(x[-1] - window, x[0] + window))
        near = abs(x - centre) <= 1.001 * window
        fit = np.polyfit(x[near] - x[k], y[near], min(2, near.sum() - 1))
        result[k] = np.exp(fit[-1])
    return result


def merge(case: Case, results: list[dict]) -> dict:
    """Merge the ranges of a case into one table (SI units)."""
    model, delta_c = case.model, case.model.critical_indentation
    columns = {
        k: []
        for k in (
            "indentation_m",
            "force_N",
            "contact_radius_m",
            "contact_area_m2",
            "contact_area_inner_m2",
            "contact_area_outer_m2",
            "force_smoothed_N",
            "loading_work_J",
        )
    }
    summary, unloading, meshes, work_below = [], [], {}, 0.0
    for part, result in zip(case.ranges, results, strict=False):
        loading = {k: np.array(v) for k, v in result["loading"].items()}
        omega = np.array(result["omega"])
        depth = loading["indentation_m"]
        if case.model.wave_amplitude:
            loading["force_smoothed_N"] = loading["force_N"]
        else:
            # The edge lies between the last node in contact and the first free node.
            inner, outer = (
                np.sqrt(loading[f"contact_area_{k}_m2"] / np.pi) for k in ("inner", "outer")
            )
            radius = smooth_over_steps(depth, 0.5 * (inner + outer))
            loading["contact_area_m2"] = np.pi * radius**2
            loading["force_smoothed_N"] = smooth_over_steps(depth, loading["force_N"])
        work = loading_work(loading["indentation_m"], loading["force_N"])
        first = int(np.argmin(abs(omega - part.low)))
        mesh = dict(result["mesh"])
        if columns["force_N"]:
            work += work_below - work[first]
            mesh["force_over_last_range_at_low"] = (
                loading["force_smoothed_N"][first] / columns["force_smoothed_N"][-1]
            )
            first += 1
        for name in columns:
            if name in loading:
                columns[name] += list(loading[name][first:])
        columns["loading_work_J"] += list(work[first:])
        columns["contact_radius_m"] += list(np.sqrt(loading["contact_area_m2"][first:] / np.pi))
        work_below = work[-1]
        meshes[part.name] = mesh
        for path in result["unloading"]:
            k = int(np.argmin(abs(omega - path["omega"])))
            returned = unloading_work(path["indentation_m"], path["force_N"])
            unloading.append({**path, "mesh_range": part.name})
            summary.append(
                {
                    "omega": path["omega"],
                    "indentation_m": loading["indentation_m"][k],
                    "force_N": loading["force_N"][k],
                    "force_smoothed_N": loading["force_smoothed_N"][k],
                    "contact_area_m2": loading["contact_area_m2"][k],
                    "contact_area_inner_m2": loading["contact_area_inner_m2"][k],
                    "contact_area_outer_m2": loading["contact_area_outer_m2"][k],
                    "loading_work_J": work[k],
                    "unloading_work_J": returned,
                    "restitution": np.sqrt(returned / work[k]),
                    "residual_indentation_m": path["indentation_m"][-1],
                    "mesh_range": part.name,
                }
            )
    return {
        "case": case.name,
        "model": {
            "youngs_modulus_Pa": model.youngs_modulus,
            "poissons_ratio": model.poissons_ratio,
            "yield_strength_Pa": model.yield_strength,
            "hardening_modulus_Pa": model.hardening_modulus,
            "hardening_exponent": model.hardening_exponent,
            "radius_m": model.radius,
            "wave_amplitude_m": model.wave_amplitude,
            "wavelength_m": model.wavelength,
            "kinematics": case.kinematics,
        },
        "contact_modulus_Pa": model.contact_modulus,
        "critical_indentation_m": delta_c,
        "mesh": meshes,
        "loading": columns,
        "unloading": unloading,
        "summary": summary,
        "versions": solve.versions(),
    }


def _round(value):
    if isinstance(value, dict):
        return {k: _round(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_round(v) for v in value]
    if isinstance(value, (float, np.floating)):
        return float(f"{value:.7g}")
    return value


def write(result: dict, file: Path) -> None:
    """Write a result with 7 significant digits, one list of numbers per line."""
    text = json.dumps(_round(result), indent=1)
    text = re.sub(
        r"\[\s+([^\[\]{}]*?)\s+\]", lambda m: "[" + re.sub(r"\s+", " ", m.group(1)) + "]", text
    )
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text + "\n")


def main() -> None:
    """Run the cases named on the command line, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="cases to run; left out: all reference cases")
    parser.add_argument("--list", action="store_true", help="print the names of all cases")
    parser.add_argument("--checks", action="store_true", help="run the convergence cases, too")
    parser.add_argument(
        "--rewrite", action="store_true", help="write the files again from the finished ranges"
    )
    parser.add_argument(
        "--partial", type=Path, default=HERE / "partial", help="folder of finished ranges"
    )
    args = parser.parse_args()
    checks = {c.name for c in check_cases()}
    known = {c.name: c for c in [*all_cases(), *check_cases()]}
    if args.list:
        print("\n".join(known))
        return
    unknown = set(args.names) - set(known)
    if unknown:
        parser.error(f"unknown cases: {', '.join(sorted(unknown))}")
    names = args.names or [n for n in known if args.checks or n not in checks]
    for name in names:
        folder = HERE / "data" / "checks" if name in checks else HERE / "data"
        file = folder / f"{name}.json"
        case = known[name]
        if file.exists() and not args.rewrite:
            finished = json.loads(file.read_text())["mesh"]
            if len(finished) == len(case.ranges):
                continue
        for merged in run_case(case, args.partial):
            write(merged, file)
        for row in merged["summary"]:
            print(
                f"{name} omega {row['omega']:g}: F {row['force_N']:.6g} N, area "
                f"{row['contact_area_m2']:.5g} m2, COR {row['restitution']:.5f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
