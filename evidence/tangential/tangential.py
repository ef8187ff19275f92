"""The tangential law of oblique impacts against tangential boundary elements.

Writes tangential.csv and prints the table of docs/oblique.md. Half an hour.

Each contact is run as a case, and the one-dimensional law (`impacts.foundation`) is made from its
stored results as in `restitution simulate`. The boundary elements (`contact.tangential`) solve
the same contact. At the deepest point and half-way through unloading, with the normal force held
constant, the study compares the tangential stiffness without slip, the force at three
displacements, and the energy of a loop. Over whole oblique impacts with the same normal motion, it
compares the tangential force and the tangential restitution. The constants of
`impacts/tangential_error` come from the samples that are not `blind`.
"""

from __future__ import annotations

import itertools
import math
import tempfile
import tomllib
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evidence.shared import write_table
from restitution import run, solve, step
from restitution.case.case_file import parse_case
from restitution.contact.state import State
from restitution.contact.tangential import TangentialState, shear
from restitution.errors import DomainError
from restitution.impacts.foundation import Foundation
from restitution.impacts.stored_force import StoredForce, stored_force
from restitution.impacts.tangential_error import TangentialError, tangential_error
from restitution.impacts.time_integration import collide_in_time

FRICTION = 0.3
# Displacements over the displacement at which a smooth sphere slides, 3/2 of µN/stiffness.
SHARES = (0.3, 0.6, 0.9)
ANGLES = (0.7, 1.5, 3.0)  # tan θ/µ of the impacts
STEPS = 40  # of an impact
TOUCH = 1e-14  # displacement (m) without slip
FEWEST = 150  # nodes of a contact that is compared


@dataclass(frozen=True)
class Sample:
    """One contact: roughness (um), yield, Poisson's ratio, depth (nm), grid and curves."""

    rms: float
    length: str
    seed: int
    interface: str
    depth: float
    poisson: float
    curves: int
    kind: str = "gaussian"
    blind: bool = False

    def text(self) -> str:
        """The case file."""
        rough = f"""[roughness]
kind = "{self.kind}"
rms = "{self.rms} um"
correlation_length = {self.length}
seed = {self.seed}
"""
        spacing = 0.0125 * math.sqrt(self.depth)  # 0.25 um at 400 nm
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
nodes = 128
spacing = "{spacing:.6g} um"
[indentation]
from = "{self.depth / 20} nm"
to = "{self.depth} nm"
steps = 16
[unloading]
curves = {self.curves}
"""


ELASTIC = 'yield_pressure = "elastic"'
# Values from which the samples are drawn: rms, length, interface, depth, Poisson's ratio, curves
# and kind. With two lengths, the roughness has a lay, along the motion or across it.
FIRST = (
    (0.02, 0.05, 0.1, 0.3),
    (*('"1 um"', '"2 um"', '"3 um"') * 2, '["4 um", "1 um"]', '["1 um", "4 um"]'),
    (ELASTIC, 'yield_pressure = "1.5 GPa"', 'yield_strength = "500 MPa"'),
    (50, 150, 400),
    (0.0, 0.25, 0.45),
    (3, 6, 16),
    ("gaussian",),
)
SECOND = (
    (0.03, 0.08, 0.2),
    ('"1.5 um"', '"2.5 um"', '["3 um", "1 um"]'),
    (
        ELASTIC,
        'yield_pressure = "1 GPa"',
        'yield_pressure = "2.5 GPa"',
        'yield_strength = "350 MPa"',
        'yield_strength = "800 MPa"',
    ),
    (80, 250),
    (0.15, 0.35, 0.49),
    (3, 5, 8, 16),
    ("gaussian", "exponential"),
)
THIRD = (
    (0.02, 0.05, 0.1, 0.3),
    ('"1 um"', '"2 um"', '"3 um"', '["4 um", "1 um"]', '["1 um", "4 um"]'),
    (ELASTIC, 'yield_pressure = "1.5 GPa"', 'yield_strength = "500 MPa"'),
    (50, 150, 400),
    (0.0, 0.25, 0.45),
    (3, 6, 16),
    ("gaussian", "exponential"),
)
FOURTH = (
    (0.03, 0.07, 0.15),
    ('"1.2 um"', '"2.2 um"', '"3.5 um"', '["3 um", "1 um"]'),
    (
        ELASTIC,
        'yield_pressure = "0.8 GPa"',
        'yield_pressure = "2 GPa"',
        'yield_strength = "350 MPa"',
        'yield_strength = "800 MPa"',
    ),
    (60, 110, 320),
    (0.1, 0.3, 0.4, 0.49),
    (2, 4, 10, 16),
    ("gaussian", "exponential"),
)
# Values, seed, number of samples, and whether they were drawn after the constants were fixed.
SETS = (
    (FIRST, 1, 60, False),
    (SECOND, 2, 48, False),
    (THIRD, 3, 27, True),
    (FOURTH, 4, 35, True),
)


def drawn(values: tuple, seed: int, *, blind: bool) -> Iterator[Sample]:
    """Random samples without end."""
    rng = np.random.default_rng(seed)
    while True:
        rms, length, interface, depth, poisson, curves, kind = (
            one[int(rng.integers(len(one)))] for one in values
        )
        yield Sample(
            rms, length, int(rng.integers(10**6)), interface, depth, poisson, curves, kind, blind
        )


def smooth(values: tuple, *, blind: bool) -> list[Sample]:
    """Smooth bodies with every model of yield."""
    _, _, interfaces, depths, poisson, *_ = values
    return [
        Sample(0.0, "", 0, interface, depths[-1], poisson[1], 3, blind=blind)
        for interface in interfaces
    ]


class Springs:
    """The one-dimensional law, with the interface of `Nodes`."""

    def __init__(self, springs: Foundation, factor: float = 1.0) -> None:
        self.springs, self.factor = springs, factor
        self.u, self.loss, self.at = np.zeros(self.springs.radius.size), 0.0, 0.0

    def move(self, displacement: float, normal: State, deepest: float) -> float:
        """The tangential force after a step."""
        loads = self.springs.load(normal.indentation, deepest)
        loads *= normal.force / max(loads.sum(), 1e-300)
        self.u, force, work = self.springs.move(
            self.u, displacement - self.at, FRICTION * loads, self.factor
        )
        self.loss, self.at = self.loss + float(work), displacement
        return float(force)


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


def held(springs: Callable[[], Springs], state: State, deepest: float) -> dict[str, float]:
    """Relative differences of the law at the normal force of `state`, held constant."""

    def force(make: Callable[[], Springs | Nodes], place: float) -> float:
        return make().move(place, state, deepest)

    stiffness = force(Nodes, TOUCH) / TOUCH
    far = 1.5 * FRICTION * state.force / stiffness
    row = {"stiffness": force(springs, TOUCH) / TOUCH / stiffness - 1}
    for share in SHARES:
        whole = force(Nodes, share * far)
        row[f"ratio_{share}"] = whole / (FRICTION * state.force)
        row[f"force_{share}"] = force(springs, share * far) / whole - 1
    there = 0.6 * far * np.linspace(0, 1, 7)[1:]
    back = 0.6 * far * np.cos(np.linspace(0, 2 * math.pi, 33))[1:]
    losses = []
    for side in (springs(), Nodes()):
        for place in there:
            side.move(place, state, deepest)
        first = side.loss
        for place in back:
            side.move(place, state, deepest)
        losses.append(side.loss - first)
    return row | {"loop": losses[0] / losses[1] - 1}


def impacts(
    law: StoredForce, foundation: Foundation, deepest: State, error: TangentialError
) -> dict[str, float]:
    """Differences over whole oblique impacts that turn at `deepest`."""
    mass = law.pair.mass or math.nan
    velocity = min(math.sqrt(2 * deepest.loading_work / mass), law.highest)
    normal = collide_in_time(law, velocity)
    times = np.linspace(0, normal.duration, STEPS + 1)[1:-1]
    at, first = np.unique(normal.time, return_index=True)
    depths, dt = np.interp(times, at, normal.indentation[first]), float(times[1] - times[0])
    turn = int(np.argmax(depths))
    states: list[State] = []
    for k, x in enumerate(map(float, depths)):
        before = states[-1] if states else None
        down = k <= turn
        states.append(solve(deepest.contact, x, start=before) if down else step(deepest, x))
    far = np.maximum.accumulate(depths)
    row = {}
    for tangent in ANGLES:
        found = []
        soft, stiff = 1 / (1 + error.stiffness), 1 + error.stiffness
        for side in (
            *(Springs(foundation, factor) for factor in (1.0, soft, stiff)),
            Nodes(),
        ):
            place, speed, forces = 0.0, FRICTION * tangent * velocity, []
            for state, most in zip(states, map(float, far), strict=True):
                place += speed * dt
                forces.append(side.move(place, state, most))
                speed -= 3.5 * forces[-1] / mass * dt
            impulse = float(np.sum(forces)) * dt / mass / velocity
            found.append((impulse, np.array(forces)))
        (J1, T1), (low, _), (high, _), (J2, T2) = found
        full, after = FRICTION * (1 + normal.restitution), FRICTION * tangent
        spread = max(abs(low - J1), abs(high - J1))
        spread += error.impulse * abs(J1) * max(1 - abs(J1) / full, 0)
        row |= {
            f"e_t_{tangent}": 1 - J2 / after,
            f"e_t_difference_{tangent}": (J2 - J1) / after,
            f"e_t_error_{tangent}": spread / after,
            f"course_{tangent}": float(np.sqrt(np.mean((T1 - T2) ** 2) / np.mean(T2**2))),
        }
    return row


def compare(sample: Sample) -> dict[str, float | str] | None:
    """One row of the table; None if the contact has too few nodes or leaves the grid."""
    case = tomllib.loads(sample.text())
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(action="ignore"):
        try:
            run(case, out=Path(folder) / "out")
        except DomainError:
            return None
        law = stored_force(Path(folder) / "out")
        contact = parse_case(sample.text()).contact(Path(folder))
    if law.deepest < 0.999e-9 * sample.depth:
        return None
    deepest, foundation = solve(contact, law.deepest), Foundation.of(law, law.deepest)
    if deepest.contact_nodes < FEWEST:
        return None
    end, error = deepest.separation_indentation, tangential_error(law, law.deepest, FRICTION)
    half, patches = step(deepest, 0.5 * (law.deepest + end)), deepest.patch_sizes()
    row = {
        "blind": sample.blind,
        "kind": sample.kind if sample.rms else "smooth",
        "rms_um": sample.rms,
        "correlation_length": sample.length.replace('"', ""),
        "seed": sample.seed,
        "interface": sample.interface.replace('"', ""),
        "poissons_ratio": sample.poisson,
        "depth_nm": sample.depth,
        "curves": sample.curves,
        "lay": law.roughness.lay if law.roughness else 0.0,
        "patches": len(patches),
        "nodes": deepest.contact_nodes,
        "unrecovered": end / law.deepest,
        "stiffness_error": error.stiffness,
        "impulse_error": error.impulse,
    }

    def springs() -> Springs:
        return Springs(foundation)

    for name, state in (("deepest", deepest), ("half", half)):
        differences = held(springs, state, law.deepest)
        row |= {f"{name}_{key}": value for key, value in differences.items()}
    return row | impacts(law, foundation, deepest, error)


def group(row: dict) -> str:
    """The row of the printed table to which a sample belongs."""
    yielded = "yielded" if row["unrecovered"] > 1e-3 else "elastic"
    roughness = "rough" if row["rms_um"] else "smooth"
    return f"{roughness}, {yielded}{', blind' if row['blind'] else ''}"


def largest(row: dict, *parts: str) -> float:
    """The largest magnitude of the columns that contain every part."""
    return max(abs(value) for key, value in row.items() if all(part in key for part in parts))


def report(rows: list[dict]) -> None:
    """Print the largest differences of each group, and their largest ratio to the stated error."""
    print("| contacts | number | stiffness | force | loop energy | e_t | share of the error |")
    print("|---|---|---|---|---|---|---|")
    groups: dict[str, list[dict]] = {}
    for row in rows:
        groups.setdefault(group(row), []).append(row)
    for name, some in sorted(groups.items()):
        shares = [
            largest(row, part) / (factor * row["stiffness_error"])
            for part, factor in (("_stiffness", 1), ("_force_", 1), ("_loop", 3))
            for row in some
        ]
        shares += [
            abs(row[f"e_t_difference_{angle}"]) / row[f"e_t_error_{angle}"]
            for row in some
            for angle in ANGLES
        ]
        cells = [
            f"{100 * max(largest(row, part) for row in some):.1f} %"
            for part in ("_stiffness", "_force_", "_loop")
        ]
        e_t = max(largest(row, "e_t_difference") for row in some)
        print(f"| {name} | {len(some)} | {' | '.join(cells)} | {e_t:.3f} | {max(shares):.2f} |")


def main() -> None:
    """Compare all samples, write the table after each of them, and print its summary."""
    rows: list[dict] = []
    for values, seed, number, blind in SETS:
        found = 0
        for sample in itertools.chain(
            smooth(values, blind=blind), drawn(values, seed, blind=blind)
        ):
            row = compare(sample)
            if row is None:
                continue
            found += 1
            print(found, sample, flush=True)
            row.update((key, float(f"{v:.5g}")) for key, v in row.items() if isinstance(v, float))
            rows.append(row)
            write_table("tangential/tangential.csv", rows)
            if found == number:
                break
    report(rows)


if __name__ == "__main__":
    main()
