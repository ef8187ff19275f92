"""Axisymmetric finite elements for elastic-plastic contact with a rigid profile.

A deformable half-space (J2 plasticity, small strains) is pressed by a rigid frictionless body with
the gap profile g(r) = r²/(2R) + A (1 − cos(2πr/λ)). method.md gives equations and sources.

Example:
    python solve.py --yield-strength 1e9 --youngs-modulus 210e9 --poissons-ratio 0.3 --omega 2 4 8
"""

from __future__ import annotations

import argparse
import json
import os
import time

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import numba as nb  # noqa: E402
import numpy as np  # noqa: E402
import scipy  # noqa: E402
from indentation import UNLOADING_FORCE_STEP, Indentation  # noqa: E402
from problem import MeshSpec, Model, load_steps, smooth_mesh  # noqa: E402
from works import loading_work, unloading_work  # noqa: E402


def run_range(
    model: Model,
    spec: MeshSpec,
    omegas,
    low: float,
    start: float,
    coarse: float = 0.07,
    fine: float = 0.035,
    force_step: float = UNLOADING_FORCE_STEP,
    report=None,
    kinematics: str = "small",
) -> dict:
    """Load on one mesh, unload from each ω in `omegas`, and return plain numbers (SI units)."""
    began = time.perf_counter()
    body = Indentation(model, spec, kinematics)
    steps = load_steps(start, low, omegas, coarse, fine)
    stops = {int(np.argmin(abs(steps - w))): w for w in omegas}
    iterations: list[int] = []
    curve, kept = body.load(
        steps * model.critical_indentation,
        stops,
        lambda s: (iterations.append(s.iterations), report and report(s)),
    )
    unloading = []
    for k, omega in stops.items():
        try:
            path = body.unload(kept[k], force_step)
        except RuntimeError as error:
            print(f"unloading from omega {omega:g} left out: {error}", flush=True)
            continue
        unloading.append(
            {
                "omega": omega,
                "indentation_m": path.indentation,
                "force_N": path.force,
                "contact_area_m2": path.area,
            }
        )
    largest = float(np.sqrt(max(curve.area) / np.pi))
    body.close()
    return {
        "mesh": {
            "element_size_m": spec.element_size,
            "elements": body.elements,
            "elements_over_radius": round(largest / spec.element_size, 1),
            "uniform_radius_m": spec.uniform_radius,
            "uniform_depth_m": spec.uniform_depth,
            "domain_m": spec.domain,
            "domain_over_radius": round(spec.domain / largest, 1),
            "omega_low": low,
            "omega_high": float(max(omegas)),
            "fine_step": fine,
            "coarse_step": coarse,
            "newton_iterations": int(sum(iterations)),
            "run_time_s": round(time.perf_counter() - began, 1),
        },
        "omega": steps.tolist(),
        "loading": {
            "indentation_m": curve.indentation,
            "force_N": curve.force,
            "contact_area_m2": curve.area,
            "contact_area_inner_m2": curve.area_inner,
            "contact_area_outer_m2": curve.area_outer,
        },
        "unloading": unloading,
    }


def versions() -> dict[str, str]:
    """Return the versions of the packages that were used."""
    import platform
    from importlib.metadata import PackageNotFoundError, version

    found = {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "numba": nb.__version__,
    }
    for name in ("pypardiso", "mkl"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "absent"
    return found


def main() -> None:
    """Solve one model on one mesh and print a summary."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--youngs-modulus", type=float, default=210e9, help="Pa")
    parser.add_argument("--poissons-ratio", type=float, default=0.3)
    parser.add_argument("--yield-strength", type=float, help="Pa; left out: elastic")
    parser.add_argument("--hardening-modulus", type=float, default=0.0, help="Pa")
    parser.add_argument("--hardening-exponent", type=float, default=0.0)
    parser.add_argument("--radius", type=float, default=500e-6, help="m")
    parser.add_argument("--wave-amplitude", type=float, default=0.0, help="m")
    parser.add_argument("--wavelength", type=float, default=0.0, help="m")
    parser.add_argument("--omega", type=float, nargs="+", default=[2.0, 4.0, 8.0])
    parser.add_argument("--start", type=float, default=0.8, help="first ω")
    parser.add_argument("--elements", type=int, default=60, help="over the contact radius")
    parser.add_argument("--step", type=float, default=0.035, help="relative step of ω")
    parser.add_argument(
        "--kinematics",
        default="small",
        choices=("small", "deformed-contact", "finite", "flattening"),
    )
    parser.add_argument("--verbose", action="store_true")
    parser.add_argument("--output", help="JSON file for the curves")
    a = parser.parse_args()
    model = Model(
        a.youngs_modulus,
        a.poissons_ratio,
        a.yield_strength,
        a.hardening_modulus,
        a.hardening_exponent,
        a.radius,
        a.wave_amplitude,
        a.wavelength,
    )
    spec = smooth_mesh(model, max(a.omega), a.elements)

    def show(s):
        print(
            f"{s.indentation / model.critical_indentation:9.4f} {s.force:12.6g} "
            f"{s.active.sum():5d} {s.iterations:3d}",
            flush=True,
        )

    result = run_range(
        model,
        spec,
        a.omega,
        a.omega[0],
        a.start,
        fine=a.step,
        coarse=a.step,
        report=show if a.verbose else None,
        kinematics=a.kinematics,
    )
    print(result["mesh"])
    work = loading_work(result["loading"]["indentation_m"], result["loading"]["force_N"])
    E_star, R = model.contact_modulus, model.radius
    for path in result["unloading"]:
        k = int(np.argmin(abs(np.array(result["omega"]) - path["omega"])))
        d, f = path["indentation_m"][0], path["force_N"][0]
        cor = np.sqrt(unloading_work(path["indentation_m"], path["force_N"]) / work[k])
        hertz = 4 / 3 * E_star * np.sqrt(R) * d**1.5
        area = result["loading"]["contact_area_m2"][k]
        print(
            f"omega {path['omega']:7.2f}  F {f:.6g} N (Hertz {f / hertz:.5f})  "
            f"A/(pi R d) {area / (np.pi * R * d):.4f}  COR {cor:.5f}  "
            f"unloading steps {len(path['force_N'])}"
        )
    if a.output:
        with open(a.output, "w") as file:
            json.dump(result, file)


if __name__ == "__main__":
    main()
