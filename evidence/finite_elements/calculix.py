"""Sphere on flat by CalculiX: mesh, input file, run, and the works of loading and unloading.

Lengths are in units of the radius, stresses in units of the contact modulus. Only the
Debian package calculix-ccx 2.20-1 was tried.
"""

from __future__ import annotations

import os
import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from problem import load_steps
from works import loading_work, unloading_work

_NU = 0.3
_E = 1 - _NU**2  # Young's modulus over the contact modulus of one body
_DOMAIN = 300.0  # radius of the half-space over the contact radius
# CalculiX finds no contact on faces with a node on the axis. Width of these faces over the element
# size:
_AXIAL = 0.1
_YIELD_COEFFICIENT = 1.295 * np.exp(0.736 * _NU)


@dataclass(frozen=True)
class Impact:
    """One loading to the depth `omega` δ_c, and its unloading.

    Args:
        body: body that deforms: "sphere" (hemisphere held at its equator, on a rigid flat) or
            "flat" (half-space under a rigid sphere).
        strength: yield strength over the contact modulus; inf: elastic.
        omega: largest indentation over that of first yield.
        finite: finite strains.
        elements: quadratic elements over the contact radius.
        coarse: relative step of the indentation below `omega`/5.
        fine: relative step from there to `omega`.
        unloading_steps: number of steps of the whole unloading.
        scale: strength that defines δ_c of an elastic impact.
        stiffness: contact stiffness times element size over the contact modulus.
    """

    body: str
    strength: float
    omega: float
    finite: bool = True
    elements: float = 7
    coarse: float = 0.12
    fine: float = 0.08
    unloading_steps: int = 14
    scale: float = 0.0
    stiffness: float = 100.0

    @property
    def unit(self) -> float:
        """Indentation at first yield."""
        ratio = self.strength if np.isfinite(self.strength) else self.scale
        return float((np.pi * _YIELD_COEFFICIENT * ratio / 2) ** 2)

    @property
    def contact_radius(self) -> float:
        """Estimated contact radius at the largest depth."""
        growth = 1.0
        if np.isfinite(self.strength):
            growth = min(1 + 0.115 * np.log(max(self.omega, 1.0)), 1.5)
        return growth * np.sqrt(self.omega * self.unit)


@dataclass
class Mesh:
    """Nodes (r, z) and quadratic quadrilaterals of one input file, counted from 1."""

    nodes: list[tuple[float, float]] = field(default_factory=list)
    elements: list[list[int]] = field(default_factory=list)

    def add(self, points: np.ndarray, known: dict[tuple[float, float], int]) -> np.ndarray:
        """Add a logical grid of points with an odd number of rows; return its node numbers."""
        numbers = np.zeros(points.shape[:2], int)
        for i, j in np.ndindex(*numbers.shape):
            if i % 2 and j % 2:
                continue  # eight-node elements have no node in the middle
            key = tuple(np.round(points[i, j], 13))
            if key not in known:
                self.nodes.append((float(points[i, j, 0]), float(points[i, j, 1])))
                known[key] = len(self.nodes)
            numbers[i, j] = known[key]
        return numbers

    def fill(self, numbers: np.ndarray) -> np.ndarray:
        """Add the elements of a logical grid; return their numbers, counter-clockwise in (r, z)."""
        shape = (numbers.shape[0] // 2, numbers.shape[1] // 2)
        made = np.zeros(shape, int)
        for i, j in np.ndindex(*shape):
            a, b = 2 * i, 2 * j
            ring = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
            element = [int(numbers[a + p, b + q]) for p, q in ring]
            corners = np.array([self.nodes[n - 1] for n in element[:4]])
            x, y = corners.T
            if np.dot(x, np.roll(y, -1)) < np.dot(y, np.roll(x, -1)):
                element = [element[k] for k in (0, 3, 2, 1, 7, 6, 5, 4)]
            self.elements.append(element)
            made[i, j] = len(self.elements)
        return made


def _geometric(length: float, first: float, ratio: float) -> np.ndarray:
    """Positions from 0 to 1 whose spacings grow by `ratio`, with a midpoint in each interval."""
    count = max(2, int(np.ceil(np.log(1 + length * (ratio - 1) / first) / np.log(ratio))))
    corners = np.concatenate([[0], np.cumsum(ratio ** np.arange(count))])
    corners /= corners[-1]
    return np.sort(np.concatenate([corners, 0.5 * (corners[1:] + corners[:-1])]))


def _body_points(kind: str, a: float, h: float) -> tuple[np.ndarray, np.ndarray]:
    """Logical grids of a body below its surface z = 0 at r = 0: under the contact, and outside."""
    width, depth = 1.15 * a, 0.6 * a
    columns, rows = 2 * round(width / h), 2 * round(depth / h)
    r, t = np.linspace(0, width, columns + 1), np.linspace(0, depth, rows + 1)
    first = _AXIAL * h
    r = np.concatenate([[0, first / 2, first, (first + r[2]) / 2], r[2:]])

    def top(x):
        return np.sqrt(1 - x**2) - 1 if kind == "sphere" else np.zeros_like(x)

    inner = np.stack(np.broadcast_arrays(r[:, None], top(r)[:, None] - t[None, :]), axis=-1)
    path = np.concatenate([inner[-1, :], inner[-2::-1, -1]])
    s = np.linspace(0, 1, len(path))
    if kind == "sphere":
        x = _geometric(1.0, h, 1.3)
        angle = np.arcsin(width) + x * (np.pi / 2 - np.arcsin(width))
        side = np.stack([np.sin(angle), np.cos(angle) - 1], axis=-1)
        axis = np.stack([0 * x, -depth - x * (1 - depth)], axis=-1)
        far = np.stack([1 - s, 0 * s - 1], axis=-1)
    else:
        size = _DOMAIN * a
        x = _geometric(size, h, 1.5)
        side = np.stack([width + x * (size - width), 0 * x], axis=-1)
        axis = np.stack([0 * x, -depth - x * (size - depth)], axis=-1)
        far = size * np.stack([np.cos(s * np.pi / 2), -np.sin(s * np.pi / 2)], axis=-1)
    X, S = x[None, :, None], s[:, None, None]
    corners = (1 - S) * ((1 - X) * side[0] + X * side[-1]) + S * ((1 - X) * axis[0] + X * axis[-1])
    outer = (1 - X) * path[:, None] + X * far[:, None] + (1 - S) * side + S * axis - corners
    outer[0, :, :], outer[-1, :, :] = side, axis
    return inner, outer


def _edges(mesh: Mesh, nodes: set[int], elements: np.ndarray) -> list[tuple[int, int]]:
    """Sides (element, 1 to 4) of `elements` whose three nodes are all in `nodes`."""
    sides = []
    for number in elements.ravel():
        e = mesh.elements[number - 1]
        for k in range(4):
            if {e[k], e[(k + 1) % 4], e[4 + k]} <= nodes:
                sides.append((int(number), k + 1))
    return sides


def _lines(numbers, per_line: int = 12) -> str:
    numbers = [str(n) for n in numbers]
    parts = [numbers[i : i + per_line] for i in range(0, len(numbers), per_line)]
    return "".join(", ".join(part) + ",\n" for part in parts)


def _deformable(mesh: Mesh, kind: str, a: float, h: float):
    """Add a deformable body below its surface; return elements, surface sides and fixed nodes."""
    known: dict[tuple[float, float], int] = {}
    grids = [mesh.add(points, known) for points in _body_points(kind, a, h)]
    made = np.concatenate([mesh.fill(grid).ravel() for grid in grids])
    surface = [*grids[0][:, 0], *grids[1][0, :]]
    near = [int(n) for n in dict.fromkeys(surface) if mesh.nodes[n - 1][0] < 1.4 * a]
    far = sorted({int(n) for n in grids[1][:, -1] if n})
    return made, _edges(mesh, set(near), made), far


def _rigid(mesh: Mesh, kind: str, a: float):
    """Add the rigid body above the contact; return elements, surface sides and nodes."""
    faces = [0, 0.002, 2.6] if kind == "flat" else np.linspace(0, 2.6, 131)
    r = a * np.interp(np.arange(0, len(faces) - 0.5, 0.5), np.arange(len(faces)), faces)
    surface = 1 - np.sqrt(1 - r**2) if kind == "sphere" else 0 * r
    top = surface.max() + a
    t = np.linspace(0, 1, 3)
    z = surface[:, None] + t * (top - surface[:, None])
    grid = mesh.add(np.stack(np.broadcast_arrays(r[:, None], z), axis=-1), {})
    made = mesh.fill(grid)
    nodes = sorted({int(n) for n in grid.ravel() if n})
    return made.ravel(), _edges(mesh, {int(n) for n in grid[:, 0]}, made), nodes


def _steps(impact: Impact) -> tuple[np.ndarray, np.ndarray]:
    """Depths over δ_c of the loading and of the unloading."""
    start = impact.omega / 30
    loading = load_steps(start, impact.omega / 5, [impact.omega], impact.coarse, impact.fine)
    share = 1.0
    if np.isfinite(impact.strength):
        # Recovered depth over the largest depth: 0.42 at ω = 32, 0.18 at 512 in the half-space.
        share = min(1.0, 1.35 * 1.47 * impact.omega**-0.345 + 0.02)
    # Equal steps of a force that falls as the recovered depth to the power 1.5
    recovered = 1 - (1 - np.linspace(0, 1, impact.unloading_steps + 1)[1:]) ** (2 / 3)
    return loading, impact.omega * (1 - share * recovered)


def write_input(impact: Impact, file: Path) -> None:
    """Write the input file of CalculiX."""
    a = impact.contact_radius
    h = a / impact.elements
    mesh, sets, sides = Mesh(), {}, {}
    body = impact.body
    sets["SOFT"], sides["SLAVE"], fixed = _deformable(mesh, body, a, h)
    other = "flat" if body == "sphere" else "sphere"
    sets["HARD"], sides["MASTER"], base = _rigid(mesh, other, a)
    axis = [n for n, (r, _) in enumerate(mesh.nodes, 1) if r == 0 and n not in base]
    text = "*NODE, NSET=ALL\n"
    text += "".join(f"{n}, {r:.12e}, {z:.12e}\n" for n, (r, z) in enumerate(mesh.nodes, 1))
    for name, members in sets.items():
        text += f"*ELEMENT, TYPE=CAX8R, ELSET={name}\n"
        text += "".join(f"{n}, {', '.join(map(str, mesh.elements[n - 1]))}\n" for n in members)
    for name, members in (
        *(("FIXED", fixed), ("MOVED", base), ("AXIS", axis)),
        ("PROBE", base[:1]),
    ):
        text += f"*NSET, NSET={name}\n{_lines(members)}"
    for name, members in sides.items():
        text += f"*SURFACE, NAME={name}, TYPE=ELEMENT\n"
        text += "".join(f"{n}, S{k}\n" for n, k in members)
    text += f"*MATERIAL, NAME=SOFT\n*ELASTIC\n{_E}, {_NU}\n"
    if np.isfinite(impact.strength):
        text += f"*PLASTIC\n{impact.strength:.10g}, 0.\n"
    text += "*SOLID SECTION, ELSET=SOFT, MATERIAL=SOFT\n"
    text += f"*MATERIAL, NAME=HARD\n*ELASTIC\n{_E}, {_NU}\n"
    text += "*SOLID SECTION, ELSET=HARD, MATERIAL=HARD\n"
    text += "*SURFACE INTERACTION, NAME=TOUCH\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n"
    text += f"{impact.stiffness / h:.6g}\n"
    text += "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE\nSLAVE, MASTER\n"
    loading, unloading = _steps(impact)
    depth = impact.unit * np.concatenate([[0.0], loading, unloading])
    text += "*AMPLITUDE, NAME=PATH, TIME=TOTAL TIME\n"
    text += "".join(f"{k}., {-d:.10e}\n" for k, d in enumerate(depth))
    text += "*BOUNDARY\nAXIS, 1, 1\n"
    text += "FIXED, 2, 2\n" if body == "sphere" else "FIXED, 1, 2\n"
    kind = "NLGEOM" if impact.finite else "NLGEOM=NO"
    for count in (len(loading), len(unloading)):
        text += f"*STEP, {kind}, INC=2000\n*STATIC\n1., {count}., 1e-4, 1.\n"
        text += "*CONTROLS, PARAMETERS=FIELD\n5e-4, 5e-3\n"
        text += "*BOUNDARY, AMPLITUDE=PATH\nMOVED, 1, 1, 0.\nMOVED, 2, 2, 1.\n"
        text += "*NODE PRINT, NSET=MOVED, TOTALS=ONLY\nRF\n*NODE PRINT, NSET=PROBE\nU\n*END STEP\n"
    file.write_text(text)


def solve(impact: Impact, folder: Path, name: str) -> np.ndarray:
    """Run CalculiX with one thread; return rows of step, depth and force."""
    write_input(impact, folder / f"{name}.inp")
    threads = {"OMP_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"}
    with open(folder / f"{name}.log", "w") as log:
        subprocess.run(["ccx", name], cwd=folder, stdout=log, env=os.environ | threads)
    curve = read_output(folder / f"{name}.dat")
    if not len(curve) or curve[-1, 2] > 1e-3 * curve[:, 2].max():
        raise RuntimeError(f"CalculiX stopped: {(folder / f'{name}.log').read_text()[-300:]}")
    return curve


def read_output(file: Path) -> np.ndarray:
    """Read rows of step, depth and force from a .dat file.

    CalculiX prints the force on a sector of two degrees.
    """
    force, depth = {}, {}
    for block in re.split(r"\n (?=total force|displacements)", file.read_text()):
        head, _, body = block.partition("\n")
        if "time" not in head:
            continue
        # Numbers below 1e-99 have no E: 1.0-310
        first = re.sub(r"(\d)-\d{3}\b", r"\1E-99", body).split()
        if head.startswith("total force"):
            force[float(head.split()[-1])] = -180 * float(first[1])
        else:
            depth[float(head.split()[-1])] = -float(first[2])
    return np.array([[step, depth[step], force[step]] for step in sorted(force)])


def works(curve: np.ndarray) -> tuple[float, float, float]:
    """Return the largest force, and the works of loading and unloading."""
    depth, force = curve[:, 1], curve[:, 2]
    top = int(np.argmax(depth))
    loaded = np.flatnonzero(force[: top + 1] > 0)
    loading = loading_work(depth[loaded], force[loaded])[-1]
    return force[top], loading, unloading_work(depth[top:], force[top:])
