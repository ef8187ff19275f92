"""Rigid rough sphere pressed into an elastic-plastic half-space, with Tamaas.

Runs in an environment of its own that holds tamaas, numpy and scipy (see method.md); nothing else
in this project needs them. `contact.py` solves; here are the surfaces, the loading and the files.

Units inside: micrometre, MPa, hence micronewton; files are in SI units.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
import argparse
import json
import platform
import time

import numpy as np
import scipy
import tamaas as tm

from contact import Contact, State


def work(delta, force):
    """Integral of F d(delta), F^(2/3) linear between the points."""
    g = np.asarray(force) ** (2 / 3)
    d = np.diff(delta)
    g1, g2 = g[:-1], g[1:]
    same = np.abs(g2 - g1) < 1e-9 * (g2 + g1 + 1e-300)
    mean = np.where(same, g1**1.5, (g2**2.5 - g1**2.5) / (2.5 * np.where(same, 1, g2 - g1)))
    return float(np.sum(d * mean))


def band_limited(n, length, rms, shortest, rolloff, hurst, seed, reference_n=None):
    """Random-phase surface; the same surface for every n.

    Power spectrum constant from the longest wavelength to `rolloff`, then
    |q|^-2(1+hurst) to `shortest`, zero beyond.  Phases belong to the integer
    wave numbers, so a finer grid samples the same function.
    """
    rng = np.random.default_rng(seed)
    kmax = int(np.floor(length / shortest))
    k = np.arange(-kmax, kmax + 1)
    kx, ky = np.meshgrid(k, k, indexing="ij")
    phase = rng.uniform(0, 2 * np.pi, kx.shape)
    kk = np.hypot(kx, ky) / length
    half = ((kx > 0) | ((kx == 0) & (ky > 0))) & (kk <= 1 / shortest)
    amp = np.where(half, np.maximum(kk, 1 / rolloff) ** -(1 + hurst), 0)
    amp *= rms / np.sqrt(np.sum(amp**2) / 2)
    x = (np.arange(n) - n // 2) * (length / n)
    ex = np.exp(2j * np.pi * np.outer(x, k) / length)
    return (ex @ (amp * np.exp(1j * phase)) @ ex.T).real


def run(case, solver, forces, unload_at, unload_steps, meta, out, log=print):
    start = time.time()
    data = dict(meta, case=case)
    load = [(solver.approach(), 0.0, 0.0)]
    unloading, summary = [], []
    for i, f in enumerate(forces):
        t = time.time()
        it = solver.step(f)
        load.append((solver.approach(), f, solver.area()))
        peak = float(solver.plastic_strain().max())
        log(
            f"{case} F={f:.6g} d={load[-1][0]:.6f} A={load[-1][2]:.4g} "
            f"ep={peak:.3e} it={it} {time.time() - t:.1f}s",
            flush=True,
        )
        if i in unload_at:
            state = State(solver)
            back = [(load[-1][0], f, load[-1][2])]
            solver.guess[...] = 0
            for s in np.arange(1, unload_steps + 1) / unload_steps:
                g = f * (1 - s) ** 1.5 if s < 1 else 0.0
                if g > 0:
                    try:
                        solver.step(g)
                    except tm.FloatingPointError:  # contact of a single node,
                        continue  # which the solver refuses
                else:
                    solver.force = 0.0  # last contact; no stress changes
                back.append((solver.approach(), g, solver.area() if g > 0 else 0.0))
            rise = float(solver.plastic_strain().max()) - peak
            depth_map = solver.plastic_strain().max(axis=(1, 2))
            a, b = np.array(load), np.array(back)
            wl, wu = work(a[:, 0], a[:, 1]), -work(b[:, 0], b[:, 1])
            summary.append(
                {
                    "indentation_m": a[-1, 0] * 1e-6,
                    "force_N": f * 1e-6,
                    "contact_area_m2": a[-1, 2] * 1e-12,
                    "loading_work_J": wl * 1e-12,
                    "unloading_work_J": wu * 1e-12,
                    "restitution": float(np.sqrt(wu / wl)),
                    "max_plastic_strain": peak,
                    "max_plastic_strain_rise_in_unloading": rise,
                    "max_plastic_strain_by_layer": [float(v) for v in depth_map],
                }
            )
            unloading.append(
                {
                    "from_indentation_m": a[-1, 0] * 1e-6,
                    "indentation_m": list(b[:, 0] * 1e-6),
                    "force_N": list(b[:, 1] * 1e-6),
                    "contact_area_m2": list(b[:, 2] * 1e-12),
                }
            )
            log(
                f"  unloaded: COR={summary[-1]['restitution']:.5f} "
                f"rise={rise:.2e} {time.time() - start:.0f}s",
                flush=True,
            )
            state.restore(solver)
        a = np.array(load)
        data["loading"] = {
            "indentation_m": list(a[:, 0] * 1e-6),
            "force_N": list(a[:, 1] * 1e-6),
            "contact_area_m2": list(a[:, 2] * 1e-12),
        }
        data["unloading"], data["summary"] = unloading, summary
        data["run_time_s"] = time.time() - start
        data["operator_evaluations"] = solver.evaluations
        with open(out, "w") as fh:
            json.dump(data, fh, indent=1)
    return data


def main():
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("case")
    p.add_argument("--nodes", type=int, default=64)
    p.add_argument("--length", type=float, default=64.0, help="um")
    p.add_argument("--layers", type=int, default=16)
    p.add_argument("--depth", type=float, default=12.0, help="um")
    p.add_argument("--yield-strength", type=float, default=1000.0, help="MPa")
    p.add_argument("--forces", type=float, nargs="+", default=None, help="forces of unloading, uN")
    p.add_argument("--steps", type=int, default=30)
    p.add_argument(
        "--power", type=float, default=1.5, help="forces of loading go with this power of the step"
    )
    p.add_argument("--unload-steps", type=int, default=20)
    p.add_argument("--rms", type=float, default=0.0, help="um")
    p.add_argument("--shortest", type=float, default=4.0, help="um")
    p.add_argument("--rolloff", type=float, default=8.0, help="um")
    p.add_argument("--hurst", type=float, default=0.8)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--tolerance", type=float, default=1e-4)
    p.add_argument("--elastic", action="store_true")
    p.add_argument("--no-images", action="store_true")
    p.add_argument("--epic", action="store_true")
    p.add_argument("--out", default=".")
    a = p.parse_args()
    n, length = a.nodes, a.length
    modulus, poisson, radius = 210e3, 0.3, 500.0
    if a.rms > 0:
        z = band_limited(n, length, a.rms, a.shortest, a.rolloff, a.hurst, a.seed)
        z = z.astype(np.float32).astype(float)
    else:
        z = np.zeros((n, n))
    solver = Contact(
        z,
        length,
        a.depth,
        a.layers,
        modulus,
        poisson,
        a.yield_strength,
        radius,
        elastic=a.elastic,
        images=not a.no_images,
        tolerance=a.tolerance,
        epic=a.epic,
    )
    top = max(a.forces)
    grid = top * (np.arange(1, a.steps + 1) / a.steps) ** a.power
    for f in a.forces:  # the nearest step becomes the wanted force
        grid[np.argmin(np.abs(grid ** (2 / 3) - f ** (2 / 3)))] = f
    grid = [float(f) for f in grid]
    unload_at = {grid.index(f) for f in a.forces}
    meta = {
        "case": a.case,
        "model": {
            "youngs_modulus_Pa": modulus * 1e6,
            "poissons_ratio": poisson,
            "yield_strength_Pa": a.yield_strength * 1e6,
            "hardening_modulus_Pa": 0.0,
            "radius_m": radius * 1e-6,
            "elastic": a.elastic,
        },
        "grid": {
            "nodes": n,
            "spacing_m": length / n * 1e-6,
            "depth_m": a.depth * 1e-6,
            "layers": a.layers,
            "period_m": length * 1e-6,
        },
        "heights_file": None,
        "periodic_correction_m_per_N": solver.kappa(),
        "image_correction_of_shape_and_stress": not a.no_images,
        "tolerance": a.tolerance,
        "versions": {
            "tamaas": tm.__version__,
            "numpy": np.__version__,
            "scipy": scipy.__version__,
            "python": platform.python_version(),
        },
    }
    if a.rms > 0:
        name = f"{a.case}_heights.npy"
        np.save(os.path.join(a.out, name), (z * 1e-6).astype(np.float32))
        meta["heights_file"] = name
        meta["surface"] = {
            "rms_m": a.rms * 1e-6,
            "measured_rms_m": float(z.std()) * 1e-6,
            "shortest_wavelength_m": a.shortest * 1e-6,
            "rolloff_wavelength_m": a.rolloff * 1e-6,
            "hurst": a.hurst,
            "seed": a.seed,
        }
    run(
        a.case, solver, grid, unload_at, a.unload_steps, meta, os.path.join(a.out, a.case + ".json")
    )


if __name__ == "__main__":
    main()
