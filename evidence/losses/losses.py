"""The product of the factors against the full equation of motion, on stored curves.

    python -m evidence.losses.losses

Smooth, rough, adhesive (zero range) and cohesive contacts of a sphere on a wall, each with a plate,
waves and viscosity. Writes `losses.csv`: product, `collide_in_time` with all losses, and what is
left of its energy balance. Takes some minutes.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from evidence.shared import write_table
from restitution.case.case_file import parse_case
from restitution.errors import DomainError
from restitution.impacts.stored_force import StoredForce, stored_force
from restitution.impacts.time_integration import collide_in_time
from restitution.losses.losses import Losses
from restitution.results.reader import RunResults
from restitution.results.writer import ResultsFolder
from restitution.runs.run import run_case

STEEL = """
total_error = false
[first]
radius = "3 mm"
youngs_modulus = "206 GPa"
poissons_ratio = 0.29
density = "7830 kg/m^3"
loss_tangent = {tangent}
[second]
radius = "flat"
youngs_modulus = "206 GPa"
poissons_ratio = 0.29
density = "7830 kg/m^3"
thickness = "{thickness} mm"
loss_tangent = {tangent}
[interface]
{interface}
{roughness}
[grid]
nodes = 128
spacing = "5 um"
[impact]
from = "0.1 m/s"
to = "1 m/s"
steps = 5
[unloading]
curves = 5
"""
ROUGH = """[roughness]
kind = "gaussian"
rms = "{rms} um"
correlation_length = "60 um"
seed = 1
"""
POLYMER = """
total_error = false
[first]
radius = "20 um"
youngs_modulus = "3 GPa"
poissons_ratio = 0.35
density = "1100 kg/m^3"
loss_tangent = {tangent}
[second]
radius = "flat"
youngs_modulus = "3 GPa"
poissons_ratio = 0.35
density = "1100 kg/m^3"
thickness = "{thickness} um"
loss_tangent = {tangent}
[interface]
yield_pressure = "{yields}"
work_of_adhesion = "0.05 J/m^2"
adhesion = "{adhesion}"
{range}
[grid]
nodes = 96
spacing = "40 nm"
[impact]
from = "0.08 m/s"
to = "0.3 m/s"
steps = 3
[unloading]
curves = 3
"""


def cases():
    for thickness, tangent in ((10, 0.01), (3, 0.03)):
        for strength in ("yield_pressure = 'elastic'", "yield_strength = '2 GPa'"):
            for rms in (0, 0.3, 2):
                text = STEEL.format(
                    thickness=thickness,
                    tangent=tangent,
                    interface=strength,
                    roughness=ROUGH.format(rms=rms) if rms else "",
                )
                yield f"{'rough' if rms else 'smooth'} {rms} um, {strength}", text
    for thickness, tangent in ((60, 0.01), (20, 0.03)):
        for adhesion, reach in (("jkr", ""), ("cohesive", 'equilibrium_separation = "3 nm"')):
            for yields in ("elastic", "200 MPa"):
                text = POLYMER.format(
                    thickness=thickness,
                    tangent=tangent,
                    adhesion=adhesion,
                    range=reach,
                    yields=yields,
                )
                yield f"adhesion {adhesion}, {yields}", text


def hysteresis(force: StoredForce, deepest: float) -> float:
    """Energy (J) that the stored forces lose from first touch to `deepest` (m) and back."""
    back, end, _ = force.branch(deepest)
    s = np.linspace(0, 1, 20_001) ** 2
    down, up = deepest * s, end + (deepest - end) * s
    works = (
        np.trapezoid([law(x) for x in at.tolist()], at)
        for law, at in ((force.loading, down), (back, up))
    )
    loaded, returned = works
    return float(loaded - returned)


def compare(name: str, text: str) -> list[dict]:
    with tempfile.TemporaryDirectory() as folder:
        out = ResultsFolder(Path(folder) / "out")
        run_case(parse_case(text), text, Path(folder), out)
        run = RunResults(out.path)
        force, points = stored_force(out.path), run.curve.impacts.points
        rows = []
        for point in points:
            if point.sticks:
                continue
            V = point.impact_velocity
            try:
                whole = collide_in_time(force, V)
                free = collide_in_time(replace(force, losses=Losses()), V)
            except DomainError:  # it reverses above the shallowest stored unloading curve
                continue
            energy = 0.5 * (force.pair.mass or 0.0) * V**2
            kept = energy * (1 - whole.restitution**2) - sum(whole.lost.values())
            kept -= hysteresis(force, whole.largest_indentation)
            rows.append(
                {
                    "contact": name,
                    "velocity_m_s": round(V, 4),
                    "thickness_m": run.case.losses().plate.thickness,
                    "quasi_static": round(point.restitution, 4),
                    "plate": round(point.plate_factor, 4),
                    "waves": round(point.waves_factor, 4),
                    "viscosity": round(point.viscosity_factor, 4),
                    "product": round(point.final, 4),
                    "full": round(whole.restitution, 4),
                    "full_without_losses": round(free.restitution, 4),
                    "product_minus_full": round(
                        point.final - whole.restitution * point.restitution / free.restitution, 4
                    ),
                    "loss_error": round(point.loss_error, 4),
                    "energy_left": f"{kept / energy:.1e}",
                }
            )
            print(*rows[-1].values(), flush=True)
        return rows


def main() -> None:
    rows = [row for name, text in cases() for row in compare(name, text)]
    write_table("losses/losses.csv", rows)
    for name in dict.fromkeys(row["contact"] for row in rows):
        off = [abs(row["product_minus_full"]) for row in rows if row["contact"] == name]
        print(f"| {name} | {len(off)} | {max(off):.4f} |")


if __name__ == "__main__":
    main()
