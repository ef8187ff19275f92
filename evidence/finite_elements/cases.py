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
from pathlib import Path

import numpy as np
import solve
from case_list import Case, all_cases, check_cases
from problem import crest_mesh, smooth_mesh, wave_mesh
from works import loading_work, unloading_work

HERE = Path(__file__).parent


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
