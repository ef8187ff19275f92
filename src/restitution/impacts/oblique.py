"""Oblique impact: tangential rebound, spin and friction loss from stored normal forces.

The normal motion is that of a head-on impact at the normal velocity. The contact point slides with

    U = v_t − R₁ω₁ − R₂ω₂,   dU/dt = −(7/2) T/m*,   dv_t/dt = −T/m*,   dω_i/dt = (5/2) T/(m_i R_i)

for solid spheres; T is the tangential force of a row of springs (`foundation`). Neglected: the
coupling of normal and tangential displacements of unlike materials, the torque about the normal,
rolling friction, plates, waves and viscosity. docs/oblique.md derives the condition of full slip.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from restitution.contact.bodies import Pair
from restitution.curve.columns import Array
from restitution.display import quantity, summary_html, summary_text
from restitution.errors import CaseError
from restitution.impacts.foundation import Foundation
from restitution.impacts.stored_force import StoredForce, stored_force
from restitution.impacts.tangential_error import tangential_error
from restitution.impacts.time_integration import ReferenceCollision, collide_in_time, table_rows
from restitution.losses.losses import Losses
from restitution.results.reader import RunResults

_STEPS = 4000  # number of time steps of a collision
_LEAST = 1e-3  # fraction of the largest normal force below which `sticking` is set to 0
_INERTIA = 3.5  # 1 + m R²/I of a solid sphere with moment of inertia I


@dataclass(frozen=True, eq=False)
class ObliqueCollision:
    """One oblique collision, in SI units. The arrays are time series of equal length.

    Attributes:
        velocity: Relative velocity of the centres before the impact (m/s).
        angle: Angle between this velocity and the normal (rad).
        friction: Coefficient of friction µ (dimensionless).
        normal_restitution: Ratio of the normal velocities after and before (dimensionless).
        tangential_restitution: Ratio of the tangential velocities of the centres
            (dimensionless); NaN for a head-on impact.
        rebound_angle: Angle of rebound of the centres from the normal (rad).
        spins: Angular velocities of the two bodies after the impact (rad/s); 0 for a wall.
        tangential_restitution_error: Error due to the model of the tangential force
            (dimensionless), as the next two, without that of the normal forces.
        rebound_angle_error: Error of `rebound_angle` (rad).
        spin_errors: Errors of `spins` (rad/s).
        friction_loss: Energy lost to friction (J).
        normal_loss: Energy lost in the normal contact (J).
        sliding: Whether the whole contact slides from the beginning to the end.
        time: Time since first touch (s).
        normal_force: Normal force (N).
        tangential_force: Tangential force (N).
        slip_velocity: Relative tangential velocity of the surfaces at the contact (m/s).
        sticking: Share of the normal load on sticking springs (dimensionless).
    """

    velocity: float
    angle: float
    friction: float
    normal_restitution: float
    tangential_restitution: float
    rebound_angle: float
    spins: tuple[float, float]
    tangential_restitution_error: float
    rebound_angle_error: float
    spin_errors: tuple[float, float]
    friction_loss: float
    normal_loss: float
    sliding: bool
    time: Array
    normal_force: Array
    tangential_force: Array
    slip_velocity: Array
    sticking: Array

    def _summary(self) -> list[str]:
        spins = ", ".join(f"{spin:.4g}" for spin in self.spins)
        return [
            f"{quantity(self.velocity, 'm/s')} at {math.degrees(self.angle):.4g}° from the normal, "
            f"friction {self.friction:.4g}",
            f"e_n {self.normal_restitution:.4f}, e_t {self.tangential_restitution:.4f}, rebound at "
            f"{math.degrees(self.rebound_angle):.4g}°, spins {spins} rad/s",
            f"lost: {quantity(self.friction_loss, 'J')} to friction, "
            f"{quantity(self.normal_loss, 'J')} in the normal contact; "
            + ("slides" if self.sliding else "sticks in part"),
        ]

    __repr__ = summary_text
    _repr_html_ = summary_html


def collide_obliquely(
    law: StoredForce,
    velocity: float,
    angle: float,
    friction: float,
    spins: tuple[float, float] = (0.0, 0.0),
) -> ObliqueCollision:
    """Simulate an oblique impact of the two particles of `law`, without adhesion.

    `velocity` is the relative velocity of the centres (m/s), `angle` that from the normal (rad), at
    least 0 and below π/2, and `spins` (rad/s) are positive in the direction in which friction
    accelerates a body without spin. Raises `CaseError`, and the errors of `collide_in_time`.
    """
    if not 0 <= angle < math.pi / 2:
        raise CaseError(
            f"angle: {math.degrees(angle):.6g} degrees from the normal is not the angle of an "
            "impact; give an angle from 0 to below 90 degrees"
        )
    if not (math.isfinite(friction) and friction >= 0):
        raise CaseError(f"friction: {friction} is not a coefficient of friction; give 0 or more")
    if not all(map(math.isfinite, spins)):
        raise CaseError("spins: must be finite numbers (rad/s)")
    bodies = list(zip((law.pair.first, law.pair.second), spins, strict=True))
    if any(math.isinf(body.radius) and spin != 0 for body, spin in bodies):
        raise CaseError("spins: a wall does not rotate; give 0 for the wall")
    V_n, V_t = velocity * math.cos(angle), velocity * math.sin(angle)
    law = replace(law, losses=Losses())  # its normal motion is quasi-static
    normal = collide_in_time(law, V_n)
    rolling = sum(body.radius * spin for body, spin in bodies if not math.isinf(body.radius))
    mass = law.pair.mass
    assert mass is not None  # checked by StoredForce
    error = tangential_error(law, min(normal.largest_indentation, law.deepest), friction)
    series, J, spread, loss = _slide(law, normal, V_t - rolling, friction, error.stiffness)
    e = normal.restitution
    sliding = friction * (1 + e) * mass * V_n  # impulse of full slip
    dJ = spread + error.sliding * abs(J)
    if sliding > 0:
        dJ += error.impulse * abs(J) * max(1 - abs(J) / sliding, 0.0)
    turns = spin_per_impulse(law.pair)
    after = V_t - J / mass
    rebound = math.atan2(after, e * V_n)
    return ObliqueCollision(
        velocity=velocity,
        angle=angle,
        friction=friction,
        normal_restitution=e,
        tangential_restitution=after / V_t if V_t > 0 else math.nan,
        rebound_angle=rebound,
        spins=(spins[0] + J * turns[0], spins[1] + J * turns[1]),
        tangential_restitution_error=dJ / mass / V_t if V_t > 0 else math.nan,
        rebound_angle_error=max(
            abs(math.atan2(after + change / mass, e * V_n) - rebound) for change in (-dJ, dJ)
        ),
        spin_errors=(dJ * turns[0], dJ * turns[1]),
        friction_loss=loss,
        normal_loss=0.5 * mass * V_n**2 * (1 - e**2),
        sliding=bool(series["sticking"][1:-1].max(initial=0.0) == 0),
        **series,
    )


def spin_per_impulse(pair: Pair) -> tuple[float, float]:
    """Change of spin per tangential impulse (rad/s per N s) of each body; 0 for a wall."""
    first, second = (
        0.0 if math.isinf(body.radius) else 2.5 / (body.mass or math.inf) / body.radius
        for body in (pair.first, pair.second)
    )
    return first, second


def oblique_force(run: RunResults, key: str = "angle") -> StoredForce:
    """The force law of a run for oblique impacts; `key` names what asks for them, in messages.

    Raises `CaseError` with adhesion or without mass, and `OutputError` without unloading curves.
    """
    if run.case.interface.adhesive_energy > 0:
        raise CaseError(f"{key}: oblique impacts are computed only for pairs without adhesion")
    return stored_force(run)


def course(collision: ObliqueCollision) -> list[dict[str, float]]:
    """The time series of a collision as table rows."""
    return table_rows(
        {
            "impact_velocity_m_per_s": collision.velocity,
            "angle_rad": collision.angle,
            "time_s": collision.time,
            "normal_force_N": collision.normal_force,
            "tangential_force_N": collision.tangential_force,
            "slip_velocity_m_per_s": collision.slip_velocity,
            "sticking": collision.sticking,
        }
    )


def full_slip_angle(friction: float, restitution: float, modulus_ratio: float) -> float:
    """The smallest angle of impact (rad) in full slip, for bodies without spin.

    `modulus_ratio` is G*/E*. Maw, Barber and Fawcett (1976, Wear 38, 101–114) for e = 1: ψ₁ ≥ 4χ −
    1; the same derivation holds for e < 1, because springs unload with the stiffness E*.
    """
    least = 3.5 * (1 + restitution) - restitution / modulus_ratio
    # If ψ₁ = (G*/E*) tan θ/µ is below 1, the contact sticks at first (Maw, Barber and Fawcett). So
    # full slip also needs ψ₁ ≥ 1.
    return math.atan(friction * max(least, 1 / modulus_ratio))


def full_slip_restitution(friction: float, restitution: float, angle: float) -> float:
    """Tangential restitution of the centres in full slip, from the impulse µ (1 + e) m* V_n."""
    return 1 - friction * (1 + restitution) / math.tan(angle)


def _slide(
    law: StoredForce, normal: ReferenceCollision, slip: float, friction: float, error: float
) -> tuple[dict[str, Array], float, float, float]:
    """Integrate the tangential motion, beginning with the slip velocity `slip` (m/s).

    Returns the time series of `ObliqueCollision`, the tangential impulse (N s), its error (N s) due
    to the relative `error` of the stiffness, and the friction loss (J).
    """
    from scipy.interpolate import CubicHermiteSpline

    at, first = np.unique(normal.time, return_index=True)
    depth = CubicHermiteSpline(at, normal.indentation[first], normal.closing_velocity[first])
    t = np.linspace(0.0, normal.duration, _STEPS + 1)
    dt, delta = normal.duration / _STEPS, np.maximum(depth(t), 0.0)
    back, _, _ = law.branch(min(normal.largest_indentation, law.deepest))
    springs = Foundation.of(law, normal.largest_indentation)
    turn = float(t[int(np.argmax(delta))])
    F = np.array([(law.loading if s <= turn else back)(x) for s, x in zip(t, delta, strict=True)])
    T, U, stick = np.zeros(t.size), np.full(t.size, slip), np.zeros(t.size)
    # Factors of the tangential modulus: unchanged, reduced by the error, increased by the error.
    factors = np.array([1.0, 1 / (1 + error), 1 + error])
    u, speed, loss = np.zeros((3, springs.radius.size)), np.full(3, slip), 0.0
    slowing, least = _INERTIA / (law.pair.mass or math.nan) * dt, _LEAST * F.max()
    for k in range(1, t.size):
        loads = springs.load(delta[k], delta[k] if t[k] <= turn else normal.largest_indentation)
        total = loads.sum()
        if total > 0:
            loads *= max(F[k], 0.0) / total
        free = u[0] + speed[0] * dt
        u, forces, works = springs.move(u, speed * dt, friction * loads, factors)
        if F[k] > least:
            stick[k] = loads[free == u[0]].sum() / loads.sum()
        T[k], loss = forces[0], loss + float(works[0])
        before, speed = speed, speed - slowing * forces
        U[k] = 0.5 * (before[0] + speed[0])
    impulses = (slip - speed) * dt / slowing
    spread = float(np.abs(impulses - impulses[0]).max())
    series = {
        "time": t,
        "normal_force": F,
        "tangential_force": T,
        "slip_velocity": U,
        "sticking": stick,
    }
    return series, float(impulses[0]), spread, loss
