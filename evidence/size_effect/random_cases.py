"""Energy account, order in h* and in depth of random contacts with a size effect.

Appends one row for each case to random_cases.csv; a second call resumes.
"""

import csv
import itertools
import math
import sys
from pathlib import Path

import numpy as np
from scipy.integrate import simpson

import restitution as rs
from restitution.errors import DomainError

TABLE = Path(__file__).with_name("random_cases.csv")
DEPTHS = 60  # of the sum of the force
LENGTHS = (0.0, 0.05e-6, 0.4e-6, 3e-6)


def contact(rng, length):
    nodes, spacing = int(rng.integers(56, 81)), float(rng.choice([0.1e-6, 0.2e-6]))
    grid = rs.Grid((nodes, nodes), (spacing, spacing))
    body = rs.Body(float(rng.choice([50e-6, 500e-6])), 210e9, 0.3, 7850.0)
    surface = rs.generate_surface(
        grid,
        kind=str(rng.choice(["gaussian", "exponential"])),
        rms=float(rng.choice([3e-9, 10e-9, 30e-9])),
        correlation_length=float(rng.choice([12, 24])) * spacing,
        seed=int(rng.integers(1000)),
    )
    grows, strength = bool(rng.random() < 0.5), float(rng.choice([0.3e9, 0.8e9, 2e9]))
    if grows:
        model = rs.ExpandingCavity(strength / 2.8, size_effect=length)
    else:
        model = rs.SizedBound(strength, length) if length else rs.ConstantBound(strength)
    pair = rs.Pair(body, body)
    deep = float(rng.uniform(0.3, 0.7)) * (0.5 * nodes * spacing) ** 2 / (2.4 * pair.radius)
    return rs.Contact(pair, surface, model), deep


def resolved(state):
    """Whether half of the contact is in patches of at least 20 nodes."""
    sizes = state.patch_sizes()
    return sizes.size and sizes[np.searchsorted(np.cumsum(sizes), 0.5 * sizes.sum())] >= 20


def unloading_work(deepest):
    """By Simpson's rule: step k of n of a path is at (1 - k/n)² of the depth."""
    path = list(rs.unloading_path(deepest, steps=64))
    at = np.array([state.indentation for state in path]) - path[-1].indentation
    force = np.array([state.force for state in path])
    return float(simpson(force * 2 * np.sqrt(at * at[0]), np.linspace(0, 1, force.size)))


def row(number, first):
    length = LENGTHS[number % 3 + 1]
    for seed in itertools.count(first):
        case, depth = contact(np.random.default_rng(seed), length)
        try:
            if resolved(rs.solve(case, 0.4 * depth)):
                break
        except DomainError:
            continue
    while True:
        depths = depth * np.geomspace(0.1, 1, DEPTHS)
        try:
            rs.solve(case, depth)
            states = list(rs.loading_path(case, depths))
            break
        except DomainError:  # at the edge of the grid
            depth *= 0.8
    deepest = rs.solve(case, depth)  # whose work is summed over fewer depths
    force = np.array([state.force for state in states])
    power = np.diff(np.log(np.maximum(force, 1e-300))) / np.diff(np.log(depths))
    parts = np.diff(force * depths) / (power + 1)
    outside = states[0].loading_work + float(parts.sum())
    given = np.diff([state.plastic_displacement for state in states], axis=0)
    curve = [rs.collide(state) for state in states]
    returned = unloading_work(deepest)
    order = []
    for other in LENGTHS:
        same, _ = contact(np.random.default_rng(seed), other)
        order.append(rs.collide(rs.solve(same, depth)).restitution)
    return {
        "seed": seed,
        "model": type(case.plasticity).__name__,
        "h_um": 1e6 * length,
        "depth_nm": 1e9 * depth,
        "restitution": curve[-1].restitution,
        "account": deepest.loading_work / outside - 1,
        "account_error": deepest.work_error / outside,
        "returned": returned / deepest.stored_energy - 1,
        "least_plastic_work": min(np.diff([s.plastic_work for s in states])) / deepest.loading_work,
        "backflow": float(given.min()) / float(deepest.plastic_displacement.max() or math.nan),
        "least_force_step": float(np.diff(force).min()) / force[-1],
        "least_work_step": float(np.diff([s.loading_work for s in states]).min()),
        "least_order": float(np.diff(order).min()),
        "gain": order[-1] - order[0],
    }


def main():
    known = list(csv.DictReader(TABLE.open())) if TABLE.exists() else []
    seed = int(known[-1]["seed"]) if known else -1
    for number in range(len(known), int(sys.argv[1])):
        values = row(number, seed + 1)
        seed = values["seed"]
        with TABLE.open("a", newline="") as file:
            writer = csv.DictWriter(file, values, lineterminator="\n")
            if number == 0:
                writer.writeheader()
            writer.writerow(
                {k: f"{v:.4g}" if isinstance(v, float) else v for k, v in values.items()}
            )


if __name__ == "__main__":
    main()
