"""Oblique impacts of smooth spheres of unlike materials, with the coupling that the law neglects.

Writes evidence/unlike/unlike.csv and prints its table; about ten minutes. Pressure moves unlike
surfaces tangentially, and traction moves them normally. With κ = β/(πE*), β the second constant of
Dundurs, the surfaces move relative to each other by

    u_z = K p + κ (H_x q_x + H_y q_y),   u_x = (C q)_x − κ H_x p,   u_y = (C q)_y − κ H_y p,

where H_x integrates x/r² over a cell (Johnson 1985, *Contact Mechanics*, §3.6). Pressure and
traction are solved in turn until both are in equilibrium; the traction has both components, and
|q| ≤ µ p. Under pressure alone, the sticking circle is that of Spence (1975, J. Elast. 5, 297–319)
within a cell: ln[(a + c)/(a − c)] a/2c = (µ/β) K(√(1 − c²/a²)), with the contact radius a, the
radius c of the sticking circle and the complete elliptic integral K. In impacts, the impulse of
the tangential force is compared with that for β = 0.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ellipk

from evidence.shared import write_table
from restitution.contact.influence import cerruti_displacement, love_displacement

Array = NDArray[np.float64]
NODES, ACROSS = 32, 12.0  # nodes along each side, and largest contact radius in cells
RADIUS = 200.0  # of the sphere, in cells
STEPS = 40
ALONG = 4 / 3  # compliance along over that across the force: ν = 0.25
BETA, FRICTION, ANGLES = (0.12, 0.25), (0.1, 0.3), (0.7, 1.5, 3.0, 6.0)
TURNS, SWEEPS = 12, 300  # most alternations in a step, and most iterations for the traction


def kernel(integral) -> Array:
    """Spectrum of the cell integral `integral(x, y)` at all lags, zero-padded."""
    n = np.fft.fftfreq(2 * NODES, 1 / (2 * NODES))
    return np.fft.rfft2(integral(n[:, None], n[None, :]))


def corners(antiderivative):
    """The integral over a cell of unit width, from its antiderivative."""

    def integral(x: Array, y: Array) -> Array:
        total = np.zeros(np.broadcast_shapes(x.shape, y.shape))
        for i, j in itertools.product((0.5, -0.5), repeat=2):
            total += math.copysign(1, i * j) * antiderivative(x + i, y + j)
        return total

    return integral


def apply(spectrum: Array, values: Array) -> Array:
    """Convolve `values` with a kernel."""
    padded = np.fft.rfft2(values, (2 * NODES, 2 * NODES))
    return np.fft.irfft2(spectrum * padded, (2 * NODES, 2 * NODES))[:NODES, :NODES]


ALPHA = 1 / math.pi  # compliance across the force, with E* = 1
K = kernel(lambda x, y: love_displacement(x, y, 1.0, 1.0, 1.0))
CXX = kernel(lambda x, y: cerruti_displacement(x, y, 1.0, 1.0, (ALPHA, ALONG * ALPHA)))
CYY = kernel(lambda x, y: cerruti_displacement(x, y, 1.0, 1.0, (ALONG * ALPHA, ALPHA)))
CXY = kernel(corners(lambda x, y: -(ALONG - 1) * ALPHA * np.hypot(x, y)))
HX = kernel(corners(lambda x, y: 0.5 * y * np.log(x * x + y * y) + x * np.arctan(y / x)))
HY = kernel(corners(lambda x, y: 0.5 * x * np.log(x * x + y * y) + y * np.arctan(x / y)))
# The largest eigenvalues of K and C are below the sums of their kernels.
STEP_K, STEP_C = (1 / float(abs(spectrum).max()) for spectrum in (K, CXX * 1.5))


def shear(q: Array) -> Array:
    """C q for a traction of two components, shape (2, n, n)."""
    return np.stack([apply(CXX, q[0]) + apply(CXY, q[1]), apply(CXY, q[0]) + apply(CYY, q[1])])


def accelerated(start: Array, step: float, gradient, project, tolerance: float) -> Array:
    """Minimise by accelerated projected gradients with restarts (Beck and Teboulle 2009)."""
    x, y, t = start, start, 1.0
    for _ in range(SWEEPS):
        new = project(y - step * gradient(y))
        if float(np.vdot(y - new, new - x)) > 0:
            t, y = 1.0, x
            new = project(y - step * gradient(y))
        following = 0.5 * (1 + math.sqrt(1 + 4 * t * t))
        change = new - x
        y, x, t = new + (t - 1) / following * change, new, following
        if np.abs(change).max() < tolerance:
            break
    return x


@dataclass
class Coupled:
    """A contact with history: pressure, traction, and tangential displacement of the surfaces."""

    beta: float
    friction: float
    factor: float = 1.0  # on the tangential stiffness
    p: Array = field(default_factory=lambda: np.zeros((NODES, NODES)))
    q: Array = field(default_factory=lambda: np.zeros((2, NODES, NODES)))
    place: float = 0.0

    def displacement(self) -> Array:
        """Tangential displacement of the surfaces relative to each other."""
        kappa = self.beta * ALPHA
        return shear(self.q) / self.factor - kappa * np.stack(
            [apply(HX, self.p), apply(HY, self.p)]
        )

    def move(self, overlap: Array, place: float) -> tuple[float, float]:
        """Normal and tangential force after a step to an overlap and a displacement."""
        kappa, before = self.beta * ALPHA, self.displacement()
        before[0] += place - self.place
        self.place = place
        size = max(float(np.sqrt(max(overlap.max(), 0.0)) / 10), 1e-9)
        for _ in range(TURNS):
            p, q = self.p, self.q
            target = overlap - kappa * (apply(HX, q[0]) + apply(HY, q[1]))
            self.p = accelerated(
                p,
                STEP_K,
                lambda p, b=target: apply(K, p) - b,
                lambda p: np.maximum(p, 0),
                1e-7 * size,
            )
            aim = before + kappa * np.stack([apply(HX, self.p), apply(HY, self.p)])
            most = self.friction * self.p

            def project(q: Array, most: Array = most) -> Array:
                return q * np.minimum(most / np.maximum(np.hypot(*q), 1e-300), 1.0)

            self.q = accelerated(
                project(q),
                STEP_C * self.factor,
                lambda q, b=aim: shear(q) / self.factor - b,
                project,
                1e-7 * size,
            )
            moved = max(np.abs(self.p - p).max(), np.abs(self.q - q).max())
            if self.beta == 0 or moved < 1e-5 * size:
                break
        return float(self.p.sum()), float(self.q[0].sum())


def impact(beta: float, friction: float, tangent: float, factor: float = 1.0) -> float:
    """Tangential impulse over that of full slip, for a path of Hertz's contact in time."""
    x = np.arange(NODES) - 0.5 * (NODES - 1)
    R = RADIUS
    shape, deepest = np.add.outer(x * x, x * x) / (2 * R), ACROSS**2 / R
    # Depth over time of Hertz's contact: δ'' = −F/m with F = 4/3 √R δ^1.5, m = 1.
    velocity = math.sqrt(2 * 8 / 15 * math.sqrt(R) * deepest**2.5)
    duration = 2.94 * deepest / velocity
    dt, delta, v, depths = duration / 4000, 0.0, velocity, []
    while delta >= 0:
        v -= 4 / 3 * math.sqrt(R) * max(delta, 0.0) ** 1.5 * dt
        delta += v * dt
        depths.append(delta)
    path = np.array(depths)[np.linspace(0, len(depths) - 1, STEPS + 2).astype(int)[1:-1]]
    step = len(depths) * dt / (STEPS + 1)
    contact, place, speed, impulse, full = (
        Coupled(beta, friction, factor),
        0.0,
        friction * tangent * velocity,
        0.0,
        0.0,
    )
    for depth in path:
        place += speed * step
        normal, force = contact.move(depth - shape, place)
        speed -= 3.5 * force * step
        impulse, full = impulse + force * step, full + friction * normal * step
    return impulse / full


def stick_radius(beta: float, friction: float) -> tuple[float, float]:
    """Radius of the sticking circle over a under pressure alone: computed, and Spence's (1975)."""
    x = np.arange(NODES) - 0.5 * (NODES - 1)
    shape = np.add.outer(x * x, x * x) / (2 * RADIUS)
    contact = Coupled(beta, friction)
    for depth in ACROSS**2 / RADIUS * np.arange(1, 31) / 30:
        contact.move(depth - shape, 0.0)
    sticks = (np.hypot(*contact.q) < 0.995 * friction * contact.p) & (contact.p > 0)

    def excess(c: float) -> float:
        return math.log((1 + c) / (1 - c)) / (2 * c) - friction / beta * float(ellipk(1 - c * c))

    computed = math.sqrt(int(sticks.sum()) / int((contact.p > 0).sum()))
    return computed, float(brentq(excess, 1e-3, 1 - 1e-9))


def main() -> None:
    """Compute, print and write the table."""
    for beta, friction in ((0.25, 0.1), (0.12, 0.1), (0.2, 0.2)):
        print("sticking radius, Spence's:", beta, friction, *stick_radius(beta, friction))
    table = []
    for tangent in ANGLES:
        # Without coupling, the impulse over that of full slip depends on tan θ/µ alone.
        alike, soft, stiff = (impact(0.0, 0.3, tangent, factor) for factor in (1.0, 0.9, 1.1))
        for friction, beta in itertools.product(FRICTION, BETA):
            impulse = impact(beta, friction, tangent)
            # The relative change of stiffness that changes the impulse as much as the coupling
            # does. In full slip the impulse does not depend on the stiffness.
            spread = max(abs(soft - alike), abs(stiff - alike))
            change = 0.1 * abs(impulse - alike) / spread if alike < 0.999 else 0.0
            row = {"friction": friction, "tan_over_friction": tangent, "beta": beta,
                   "impulse_alike": alike, "impulse": impulse,
                   "stiffness_change": change}  # fmt: skip
            table.append({key: float(f"{value:.5g}") for key, value in row.items()})
            print(table[-1], f"{impulse / alike - 1:+.4f}", flush=True)
    write_table("unlike/unlike.csv", table)


if __name__ == "__main__":
    main()
