"""A collision in time: the motion of two particles under the stored contact force.

    m₁ x₁'' = −F(δ),  m₂ x₂'' = F(δ),  δ = x₁ − x₂ (0 at first touch),  e = (v₂' − v₁')/(v₁ − v₂)

F is the loading curve until the particles stop, then the unloading curve. e checks (W_u/W)^½ of a
run independently: it needs the unloading forces and the equations of motion, not W_u.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from restitution.curve.columns import Array
from restitution.errors import DomainError, NotConvergedError
from restitution.impacts.stored_force import Force, StoredForce
from restitution.losses.losses import NAMES, Damping, Losses

_RTOL = 1e-10
# Integration errors can carry an impact beyond the deepest stored depth. An excess of up to this
# fraction of the depth is accepted.
_SLACK = 1e-3
# Step of the differences that give the stiffness, as a fraction of the deepest stored depth.
_DIFFERENCE = 1e-6


@dataclass(frozen=True)
class ReferenceCollision:
    """One collision: its results, and time series (arrays of equal length), in SI units.

    `lost` has the energy (J) of each of `losses.NAMES`. `blended` says whether the unloading force
    was interpolated between two stored curves.
    """

    velocity: float
    restitution: float
    duration: float
    largest_indentation: float
    largest_force: float
    rebound_first: float
    rebound_second: float
    lost: dict[str, float]
    blended: bool
    time: Array
    indentation: Array
    force: Array
    closing_velocity: Array


def collide_in_time(law: StoredForce, velocity: float) -> ReferenceCollision:
    """Integrate a head-on collision of the two particles of `law` at relative `velocity` (m/s).

    They start at first touch, in the frame of their centre of mass (or of the wall). Raises
    `DomainError` outside the computed velocities or the depths of the unloading curves, and
    `NotConvergedError` if the integration fails or reaches the end of the loading curve.
    """
    if not 0 < velocity <= law.highest * (1 + 1e-9):
        raise DomainError(
            f"velocity: {velocity:.6g} m/s is outside the computed velocities (above 0, up to "
            f"{law.highest:.4g} m/s); choose a velocity in this range, or compute higher velocities"
        )
    m1, m2 = law.pair.first.mass, law.pair.second.mass
    assert m1 is not None  # checked by StoredForce
    assert m2 is not None
    damping = Damping()
    if law.losses.present:
        damping = law.losses.damping(
            collide_in_time(replace(law, losses=Losses()), velocity).duration
        )
    motion = _Motion(m1, m2, damping, h=_DIFFERENCE * law.deepest)
    share = 1.0 if math.isinf(m2) else 0.0 if math.isinf(m1) else m2 / (m1 + m2)
    start = np.array([0.0, 0.0, share * velocity, (share - 1) * velocity, *motion.rest])

    def stop(t: float, y: Array) -> float:
        return motion.closing(law.loading, y)

    def too_deep(t: float, y: Array) -> float:
        return float(motion.indentation(y)) - law.deepest * (1 + _SLACK)

    def integrate(force: Force, start: Array, *events: Callable[[float, Array], float]) -> Any:
        rates = motion.rates(force)
        return _integrate(rates, start, motion.scales(law.deepest, velocity), velocity, events)

    down = integrate(law.loading, start, stop, too_deep)
    if down.t_events[1].size:
        raise NotConvergedError(
            f"velocity: at {velocity:.6g} m/s the stored loading curve ends before the particles "
            "stop, so the stored forces contradict the stored impact velocities; run the case again"
        )
    turn = down.y[:, -1]
    deepest = float(motion.indentation(turn))
    back, end, blended = law.branch(min(deepest, law.deepest))

    def parted(t: float, y: Array) -> float:
        return float(motion.indentation(y)) - end

    def held(t: float, y: Array) -> float:
        return motion.closing(back, y) - 1e-9 * velocity

    held.direction = 1.0  # type: ignore[attr-defined]
    up = integrate(back, turn, parted, held)
    sticks = up.t_events[1].size > 0
    closing = np.concatenate([down.y[2] - down.y[3], up.y[2] - up.y[3]])
    loaded, unloaded = motion.indentation(down.y), motion.indentation(up.y)
    force = [*map(law.loading, loaded), *map(back, unloaded)]
    return ReferenceCollision(
        velocity=velocity,
        restitution=0.0 if sticks else float(-closing[-1] / velocity),
        duration=float(down.t[-1] + up.t[-1]),
        largest_indentation=deepest,
        largest_force=max(force),
        rebound_first=float(up.y[2, -1]),
        rebound_second=float(up.y[3, -1]),
        lost=dict(zip(NAMES, up.y[5:, -1].tolist() or [0.0] * len(NAMES), strict=True)),
        blended=blended,
        time=np.concatenate([down.t, down.t[-1] + up.t]),
        indentation=np.concatenate([loaded, unloaded]),
        force=np.array(force),
        closing_velocity=closing,
    )


def course(collision: ReferenceCollision) -> list[dict[str, float]]:
    """The time series of a collision as table rows."""
    return table_rows(
        {
            "impact_velocity_m_per_s": collision.velocity,
            "time_s": collision.time,
            "indentation_m": collision.indentation,
            "force_N": collision.force,
            "closing_velocity_m_per_s": collision.closing_velocity,
        }
    )


def table_rows(columns: Mapping[str, Array | float]) -> list[dict[str, float]]:
    """Table rows from columns of equal length; a single number is repeated in every row."""
    values = [column.tolist() for column in np.broadcast_arrays(*columns.values())]
    return [dict(zip(columns, row, strict=True)) for row in zip(*values, strict=True)]


@dataclass(frozen=True)
class _Motion:
    """The equations of motion of two particles (positions, velocities; with damping also the
    displacement of the plate and the energies lost in order of `NAMES`).

    `h` (m) is the step of the differences that give the stiffness.
    """

    m1: float
    m2: float
    damping: Damping
    h: float

    @property
    def rest(self) -> list[float]:
        return [] if self.damping == Damping() else [0.0] * (1 + len(NAMES))

    def scales(self, depth: float, velocity: float) -> list[float]:
        mass = min(self.m1, self.m2)
        more = [depth] + [0.5 * mass * velocity**2] * len(NAMES) if self.rest else []
        return [depth, depth, velocity, velocity, *more]

    def indentation(self, y: Array) -> Any:
        return y[0] - y[1] - (y[4] if self.rest else 0.0)

    def closing(self, force: Force, y: Array) -> float:
        """dδ/dt (m/s)."""
        if not self.rest:
            return float(y[2] - y[3])
        return self._contact(force, y)[0]

    def _contact(self, force: Force, y: Array) -> tuple[float, float, float]:
        """dδ/dt, the force without damping, and its stiffness."""
        x, given = float(self.indentation(y)), self.damping
        F = force(x)
        stiff = max((force(x + self.h) - force(x - self.h)) / (2 * self.h), 0.0)
        c = given.time * stiff + given.radiation * stiff**2
        return (float(y[2] - y[3]) - given.mobility * F) / (1 + given.mobility * c), F, stiff

    def rates(self, force: Force) -> Callable[[float, Array], list[float]]:
        m1, m2, given = self.m1, self.m2, self.damping

        def free(t: float, y: Array) -> list[float]:
            F = force(float(y[0] - y[1]))
            return [y[2], y[3], -F / m1, F / m2]

        def damped(t: float, y: Array) -> list[float]:
            v, F, stiff = self._contact(force, y)
            viscous, waves = given.time * stiff * v, given.radiation * stiff**2 * v
            F += viscous + waves
            plate = given.mobility * F
            return [y[2], y[3], -F / m1, F / m2, plate, plate * F, waves * v, viscous * v]

        return damped if self.rest else free


def _integrate(
    rates: Callable[[float, Array], list[float]],
    start: Array,
    scales: list[float],
    velocity: float,
    events: tuple[Callable[[float, Array], float], ...],
) -> Any:
    from scipy.integrate import solve_ivp

    scale = scales[0]
    for event in events:
        event.terminal = True  # type: ignore[attr-defined]
    path = solve_ivp(
        rates,
        (0.0, 1e3 * scale / velocity),
        start,
        method="DOP853",
        events=events,
        rtol=_RTOL,
        atol=[_RTOL * one for one in scales],
        max_step=scale / velocity,
    )
    if path.status != 1:
        raise NotConvergedError(
            f"velocity: the collision at {velocity:.6g} m/s did not end ({path.message}); "
            "choose another velocity"
        )
    return path
