"""The tangential law of oblique impacts against tangential boundary elements.

    python docs/studies/tangential.py

Writes docs/studies/tangential.csv and prints the tables of docs/oblique.md. About half an hour.

Each contact is run as a case, and the one-dimensional law (`laws.foundation`) is made from its
stored results as `restitution simulate` does it. The boundary elements (`contact.tangential`) get
the same contact. Compared are, at the deepest point and half-way through unloading at a normal
force held constant: the tangential stiffness without slip, the force at three displacements, and
the energy of a loop. And over whole oblique impacts with the same normal motion: the impulse of the
tangential force, its largest value, and the tangential restitution.
"""

from __future__ import annotations

import math
import tempfile
import tomllib
import warnings
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from restitution import run, solve, step
from restitution.case.case_file import parse_case
from restitution.contact.state import State
from restitution.contact.tangential import TangentialState, shear
from restitution.laws.foundation import Foundation
from restitution.laws.time_integration import StoredForce, collide_in_time, stored_force

FRICTION = 0.3
SHARES = (0.3, 0.6, 0.9)  # of the displacement at which a smooth contact of this stiffness slides
ANGLES = (0.7, 1.5, 3.0)  # tan θ/µ of the impacts
STEPS = 60  # of an impact
SCALED = 0.1  # change of the tangential modulus that shows how much the impact depends on it


@dataclass(frozen=True)
class Sample:
    """One contact: roughness (um), yield, Poisson's ratio, depth (nm) and grid."""

    rms: float
    length: float
    seed: int
    interface: str
    depth: float
    poisson: float = 0.25
    nodes: int = 128
    spacing: float = 0.25
    depths: int = 16
    curves: int = 3
    blind: bool = False

    def text(self) -> str:
        """The case file."""
        rough = f"""[roughness]
kind = "gaussian"
rms = "{self.rms} um"
correlation_length = "{self.length} um"
seed = {self.seed}
"""
        return f"""total_error = false
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = {self.poisson}
density = "7850 kg/m^3"
[interface]
{self.interface}
{rough if self.rms else ""}
[grid]
nodes = {self.nodes}
spacing = "{self.spacing} um"
[indentation]
from = "{self.depth / 20} nm"
to = "{self.depth} nm"
steps = {self.depths}
[unloading]
curves = {self.curves}
"""


ELASTIC = 'yield_pressure = "elastic"'
CONSTANT = 'yield_pressure = "1.5 GPa"'
CAVITY = 'yield_strength = "500 MPa"'


class Springs:
    """The one-dimensional law, with the interface of `Nodes`."""

    def __init__(self, springs: Foundation) -> None:
        self.springs = springs
        self.u, self.loss, self.at = np.zeros(self.springs.radius.size), 0.0, 0.0

    def move(self, displacement: float, normal: State, deepest: float) -> float:
        """The tangential force after a step."""
        loads = self.springs.load(normal.indentation, deepest)
        loads *= normal.force / max(loads.sum(), 1e-300)
        self.u, force, work = self.springs.move(self.u, displacement - self.at, FRICTION * loads)
        self.loss, self.at = self.loss + work, displacement
        return force


class Nodes:
    """The boundary elements."""

    def __init__(self) -> None:
        self.state: TangentialState | None = None

    def move(self, displacement: float, normal: State, deepest: float) -> float:
        """The tangential force after a step."""
        self.state = shear(normal, displacement, FRICTION, history=self.state, residual=1e-6)
        return self.state.force

    @property
    def loss(self) -> float:
        """Energy lost to friction (J)."""
        return 0.0 if self.state is None else self.state.friction_loss


def held(foundation: Foundation, state: State, deepest: float) -> dict[str, float]:
    """Relative differences of the law at the normal force of `state`, held constant."""

    def forces(make, path):
        side = make()
        found = [side.move(place, state, deepest) for place in path]
        return np.array(found), side

    def springs():
        return Springs(foundation)

    (touch,), _ = forces(Nodes, [1e-14])
    stiffness = touch / 1e-14
    (soft,), _ = forces(springs, [1e-14])
    far = 1.5 * FRICTION * state.force / stiffness
    row = {"stiffness": soft / 1e-14 / stiffness - 1}
    for share in SHARES:
        (one,), _ = forces(springs, [share * far])
        (whole,), _ = forces(Nodes, [share * far])
        row[f"ratio_{share}"] = whole / (FRICTION * state.force)
        row[f"force_{share}"] = one / whole - 1
    there = 0.6 * far * np.linspace(0, 1, 7)[1:]
    back = 0.6 * far * np.cos(np.linspace(0, 2 * math.pi, 33))[1:]
    losses = []
    for make in (springs, Nodes):
        side = make()
        for place in there:
            side.move(place, state, deepest)
        first = side.loss
        for place in back:
            side.move(place, state, deepest)
        losses.append(side.loss - first)
    return row | {"loop": losses[0] / losses[1] - 1}


def impacts(law: StoredForce, foundation: Foundation, deepest: State) -> dict[str, float]:
    """Differences over whole oblique impacts that turn at `deepest`."""
    velocity = math.sqrt(2 * deepest.loading_work / law.pair.mass)
    normal = collide_in_time(law, min(velocity, law.highest))
    times = np.linspace(0, normal.duration, STEPS + 1)[1:-1]
    at, first = np.unique(normal.time, return_index=True)
    depths = np.interp(times, at, normal.indentation[first])
    turn = int(np.argmax(depths))
    states: list[State] = []
    for k, x in enumerate(depths):
        before = states[-1] if states else None
        states.append(
            solve(deepest.contact, float(x), start=before) if k <= turn else step(deepest, float(x))
        )
    far = [float(depths[: k + 1].max()) for k in range(depths.size)]
    row = {}
    for tangent in ANGLES:
        found = []
        scaled = [
            replace(foundation, moduli=(foundation.moduli[0], factor * foundation.moduli[1]))
            for factor in (1.0, 1 - SCALED, 1 + SCALED)
        ]
        for side in (*map(Springs, scaled), Nodes()):
            place, speed, forces = 0.0, FRICTION * tangent * velocity, []
            for state, most in zip(states, far, strict=True):
                place += speed * (times[1] - times[0])
                forces.append(side.move(place, state, most))
                speed -= 3.5 * forces[-1] / law.pair.mass * (times[1] - times[0])
            after = FRICTION * tangent * velocity
            impulse = np.sum(forces) * (times[1] - times[0]) / law.pair.mass
            found.append((1 - impulse / after, np.max(forces), side.loss, np.array(forces)))
        (e1, most1, loss1, T1), low, high, (e2, most2, loss2, T2) = found
        lowest, highest = min(low[0], high[0]), max(low[0], high[0])
        row |= {
            f"e_t_{tangent}": e2,
            f"e_t_difference_{tangent}": e1 - e2,
            f"e_t_scaled_{tangent}": max(e1 - lowest, highest - e1),
            f"largest_{tangent}": most1 / most2 - 1,
            f"course_{tangent}": float(np.sqrt(np.mean((T1 - T2) ** 2) / np.mean(T2**2))),
            f"loss_{tangent}": loss1 / loss2 - 1,
        }
    return row


def compare(sample: Sample) -> dict[str, float | str]:
    """One row of the table."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(action="ignore"):
        run(tomllib.loads(sample.text()), out=Path(folder) / "out")
        law = stored_force(Path(folder) / "out")
        contact = parse_case(sample.text()).contact(Path(folder))
    deepest, foundation = solve(contact, law.deepest), Foundation.of(law, law.deepest)
    end = deepest.separation_indentation
    half = step(deepest, 0.5 * (law.deepest + end))
    patches = deepest.patch_sizes()
    row = {
        "rms_um": sample.rms,
        "length_um": sample.length,
        "seed": sample.seed,
        "interface": sample.interface.split(" = ")[0]
        if "elastic" not in sample.interface
        else "elastic",
        "depth_nm": sample.depth,
        "poissons_ratio": sample.poisson,
        "blind": sample.blind,
        "patches": len(patches),
        "nodes": int(patches.sum()),
        "largest_patch": int(patches[0]),
        "unrecovered": end / law.deepest,
        "normal_difference": law.loading(law.deepest) / deepest.force - 1,
    }
    row |= {f"top_{key}": value for key, value in held(foundation, deepest, law.deepest).items()}
    row |= {f"half_{key}": value for key, value in held(foundation, half, law.deepest).items()}
    return row | impacts(law, foundation, deepest)
