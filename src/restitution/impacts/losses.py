"""Factors of the restitution due to plates, waves and viscosity, from stored forces.

Each loss alone, and all together, enter the equation of motion m ü = −(F + cδ̇), δ̇ = u − α(F + cδ̇),
c = A F′ + γ F′², where u is the approach of the bodies and δ that of the surfaces. All impacts are
integrated at once, by Runge and Kutta's method of fourth order; `collide_in_time` solves the same
equation with controlled steps.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from restitution.curve.columns import Array
from restitution.impacts.stored_force import StoredForce
from restitution.losses.losses import NAMES, Damping, Losses

_NODES = 65  # of the tables of forces
_STEP = 0.1  # of time, over the time in which the motion or the force changes
_STIFFEST = 0.5  # largest product of a step and the rate at which damping stops the motion
_MARGIN = 1.01  # of the depths of tables
_FINE = 257  # nodes of the table that gives the depth of an impact
_MOST_STEPS = 2000  # an impact that has not ended then returns nothing


@dataclass(frozen=True)
class LossFactors:
    """Factors of the quasi-static COR, shape (impacts,): of each loss by name, and of all together.

    NaN where the bodies stick without these losses. `duration` (s) is that without these losses.
    """

    alone: dict[str, Array]
    together: Array
    duration: Array

    @classmethod
    def without(cls, velocity: Array) -> Self:
        """The factors of a pair without losses; the duration is not computed."""
        one = np.ones_like(velocity)
        return cls(dict.fromkeys(NAMES, one), one, np.full_like(velocity, math.nan))

    @property
    def product(self) -> Array:
        """Product of the factors of all losses."""
        return np.asarray(np.prod(list(self.alone.values()), axis=0))

    def columns(self) -> dict[str, Array]:
        """The factors by the names of the columns of a curve, `product` and `together`."""
        return {f"{name}_factor": of for name, of in self.alone.items()} | {
            "product": self.product,
            "together": self.together,
        }


def loss_factors(law: StoredForce, losses: Losses, velocity: Array) -> LossFactors:
    """Factors of the losses at `velocity` (m/s, shape (impacts,)), within the stored depths."""
    free, duration = _rebounds(law, velocity, [Damping()] * velocity.size)
    names = losses.present
    kinds = [losses.only(name) for name in names]
    kinds += [losses] if len(kinds) > 1 else []
    damping = [kind.damping(time) for kind in kinds for time in duration.tolist()]
    e, _ = _rebounds(law, np.tile(velocity, len(kinds)), damping)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.minimum(e.reshape(len(kinds), -1) / free, 1.0)
    ratio[:, ~(free > 0)] = math.nan
    alone = LossFactors.without(velocity).alone | dict(zip(names, ratio, strict=False))
    return LossFactors(alone, ratio[-1], duration)


def _rebounds(law: StoredForce, velocity: Array, damping: Sequence[Damping]) -> tuple[Array, Array]:
    """Rebound over impact velocity (0 if the bodies stick), and duration (s), of each impact."""
    motion = _Motion(law.pair.mass or math.nan, damping)
    deepest = _depths(law, velocity)
    loading = _Table.of([_force(law.loading, depth) for depth in deepest.tolist()], 0.0, deepest)
    x, u, down = motion.until(loading, np.zeros_like(velocity), velocity, motion.stops)
    ends = np.array([law.separation(depth) for depth in x.tolist()])
    largest = loading.at(x)[0]
    unloading = _Table.of(_shapes(law, x) * largest[:, None], ends, x)
    x, u, up = motion.until(unloading, x, u, motion.parts)
    return np.maximum(-motion.stops(unloading, x, u) / velocity, 0.0), down + up


def _depths(law: StoredForce, velocity: Array) -> Array:
    """Depths (m) that impacts at `velocity` (m/s) do not exceed."""
    depths = law.deepest * np.linspace(0.0, 1.0, _FINE) ** 3
    force = np.array([law.loading(depth) for depth in depths.tolist()])
    mean, mass = 0.5 * (force[1:] + force[:-1]), law.pair.mass or math.nan
    work = np.append(0.0, np.cumsum(mean * np.diff(depths)))
    after = np.searchsorted(np.maximum.accumulate(work), 0.5 * mass * velocity**2)
    return np.asarray(_MARGIN * depths[np.minimum(after, _FINE - 1)])


def _force(loading: Callable[[float], float], depth: float) -> list[float]:
    return [loading(depth * (k / (_NODES - 1)) ** 2) for k in range(_NODES)]


def _shapes(law: StoredForce, deepest: Array) -> Array:
    s = np.linspace(0.0, 1.0, _NODES) ** 2
    known = np.array([law.shape(start)[0](s) for start in law.unloading_from])
    below, above, share = zip(*map(law.neighbours, deepest.tolist()), strict=True)
    weight = np.array(share)[:, None]
    return np.asarray((1 - weight) * known[list(below)] + weight * known[list(above)])


@dataclass(frozen=True)
class _Table:
    """Force and stiffness of each impact, at nodes that are dense near `start`."""

    force: Array
    slope: Array
    start: Array
    length: Array

    @classmethod
    def of(cls, force: object, start: Array | float, end: Array) -> _Table:
        F = np.array(force, dtype=float)
        begin = np.broadcast_to(start, end.shape)
        length = end - begin
        s = np.linspace(0.0, 1.0, _NODES)
        # dF/dx = (dF/ds)/(2 s L); it is taken from the next node at s = 0.
        slope = np.gradient(F, s, axis=1)
        slope[:, 1:] /= 2 * s[1:] * length[:, None]
        slope[:, 0] = slope[:, 1]
        return cls(F, slope, begin, length)

    def at(self, x: Array) -> tuple[Array, Array]:
        s = np.sqrt(np.clip((x - self.start) / self.length, 0.0, 1.0)) * (_NODES - 1)
        k = np.minimum(s.astype(int), _NODES - 2)
        t, rows = s - k, np.arange(x.size)
        F, dF = self.force, self.slope
        return (
            F[rows, k] + t * (F[rows, k + 1] - F[rows, k]),
            dF[rows, k] + t * (dF[rows, k + 1] - dF[rows, k]),
        )


class _Motion:
    """The equation of motion of many impacts, with a damping each."""

    def __init__(self, mass: float, damping: Sequence[Damping]) -> None:
        self.mass = mass
        self.mobility, self.radiation, self.time = np.transpose(
            [(one.mobility, one.radiation, one.time) for one in damping]
        )

    def rates(self, table: _Table, x: Array, u: Array) -> tuple[Array, Array, Array]:
        """dδ/dt and du/dt, and the rate at which damping stops the motion (1/s)."""
        F, slope = table.at(x)
        stiff = np.maximum(slope, 0.0)  # adhesion already loses what unstable contacts release
        c = self.time * stiff + self.radiation * stiff**2
        v = (u - self.mobility * F) / (1 + self.mobility * c)
        return v, -(F + c * v) / self.mass, c / self.mass + self.mobility * stiff

    def until(
        self,
        table: _Table,
        x: Array,
        u: Array,
        over: Callable[[_Table, Array, Array], Array],
    ) -> tuple[Array, Array, Array]:
        """Integrate until `over` falls to 0; returns δ, u and the time at the end."""
        largest = np.maximum(np.abs(table.force).max(axis=1), 1e-300)
        slow = np.sqrt(largest / (self.mass * table.length))
        time, running = np.zeros_like(x), np.ones(x.shape, dtype=bool)
        left = over(table, x, u)
        for _ in range(_MOST_STEPS):
            v, _, stopping = self.rates(table, x, u)
            step = _STEP / (np.abs(v) / table.length + slow)
            step = np.where(running, np.minimum(step, _STIFFEST / np.maximum(stopping, 1e-300)), 0)
            new = self._step(table, x, u, step)
            after = over(table, *new)
            ends = running & (after <= 0)
            if ends.any():
                step, new = self._shortened(table, (x, u), step, (left, after), ends, over)
            time, (x, u) = time + step, new
            left = np.where(ends, left, after)
            running &= ~ends
            if not running.any():
                return x, u, time
        return x, np.where(running, 0.0, u), time

    def _shortened(
        self,
        table: _Table,
        start: tuple[Array, Array],
        step: Array,
        around: tuple[Array, Array],
        ends: NDArray[np.bool_],
        over: Callable[[_Table, Array, Array], Array],
    ) -> tuple[Array, tuple[Array, Array]]:
        """Steps and states where `over` is 0, by regula falsi, for the impacts in `ends`."""
        low, high = np.zeros_like(step), step
        at_low, at_high = around
        for _ in range(4):
            with np.errstate(divide="ignore", invalid="ignore"):
                share = at_low / (at_low - at_high)
            part = np.where(ends, low + np.clip(share, 0.0, 1.0) * (high - low), step)
            new = self._step(table, *start, part)
            here = over(table, *new)
            above = here > 0
            low, at_low = np.where(above, part, low), np.where(above, here, at_low)
            high, at_high = np.where(above, high, part), np.where(above, at_high, here)
        return part, new

    def _step(self, table: _Table, x: Array, u: Array, step: Array) -> tuple[Array, Array]:
        v1, a1, _ = self.rates(table, x, u)
        v2, a2, _ = self.rates(table, x + 0.5 * step * v1, u + 0.5 * step * a1)
        v3, a3, _ = self.rates(table, x + 0.5 * step * v2, u + 0.5 * step * a2)
        v4, a4, _ = self.rates(table, x + step * v3, u + step * a3)
        return (
            x + step / 6 * (v1 + 2 * v2 + 2 * v3 + v4),
            u + step / 6 * (a1 + 2 * a2 + 2 * a3 + a4),
        )

    def stops(self, table: _Table, x: Array, u: Array) -> Array:
        return self.rates(table, x, u)[0]

    def parts(self, table: _Table, x: Array, u: Array) -> Array:
        """Way to separation; 0 where the bodies stick."""
        return np.where(self.rates(table, x, u)[0] > 0, 0.0, x - table.start)
