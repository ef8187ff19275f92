"""Adhesive contact models of DEM codes with damping, fitted to a law with its pull-off force."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from restitution.dem.pair import adhesive_time, contact_time, pull_off_force, unknown_pull_off
from restitution.errors import CaseError
from restitution.laws.law import Array, Law
from restitution.theory import JKR, Hertz

_NODES = 3000  # of the tables of force and damping
_STEPS = 80  # time steps in the shorter of the elastic and the adhesive contact time
_LONGEST = 40  # contact times until the integration ends
_NEAR = (0.85, 0.93, 1.08, 1.2)  # velocities of the fit, over the sticking velocity
_WEIGHT = 4.0  # of these in the fit, over that of the velocities above
_POINTS = 9  # velocities of the fit above
_SEARCH = np.geomspace(3e-3, 1.0, 7)  # damping at first, over the largest


@dataclass(frozen=True, eq=False)
class DampedAdhesion:
    """Force (N) against indentation `depth` (m), and damping (kg/s) for the strength 1.

    A contact begins at the indentation 0 and ends at the first node of the tables. `largest` is
    the largest strength. Where the whole force is tensile, the damping force is at most `cap` (N).
    """

    depth: Array
    force: Array
    damping: Array
    largest: float
    cap: float = math.inf

    def restitution(
        self, velocity: Array, mass: float, strength: float | Array, time: Array
    ) -> Array:
        """e at `velocity` (m/s); `time` (s) is the duration of each contact, at least."""
        V = np.asarray(velocity, dtype=float)
        x, v, e = np.zeros_like(V), V.copy(), np.full(V.shape, np.nan)
        receding = np.zeros(V.shape, dtype=bool)
        dt = time / _STEPS

        def rate(x: Array, v: Array) -> Array:
            force = np.interp(x, self.depth, self.force)
            damping = strength * np.interp(x, self.depth, self.damping) * v
            free = (force + damping >= 0) | (damping >= -self.cap)
            return np.asarray(-(force + np.where(free, damping, -self.cap)) / mass)

        for _ in range(_LONGEST * _STEPS):
            y, w = x + 0.5 * dt * v, v + 0.5 * dt * rate(x, v)
            before, x, u, v = x, x + dt * w, v, v + dt * rate(y, w)
            parted = np.isnan(e) & (x < self.depth[0]) & (u < 0)
            share = (before[parted] - self.depth[0]) / (before[parted] - x[parted])
            there = u[parted] + share * (v[parted] - u[parted])
            e[parted] = np.maximum(-there, 0.0) / V[parted]
            # Bodies that come back before they part have too little energy to part later.
            e[np.isnan(e) & receding & (v > 0)] = 0.0
            receding |= v < 0
            if not np.isnan(e).any():
                break
        return np.asarray(np.nan_to_num(e))


@dataclass(frozen=True)
class AdhesiveFit:
    """A damping `strength` fitted to e of a law; how far e and the sticking velocity are off.

    `pull_off_force` (N) is that of the law. `sticks_below` (m/s) is the sticking velocity of the
    model; `worst` and `worst_at` are the largest difference of e above 1.2 times the sticking
    velocity of the law, and its velocity (m/s). `miss` is the sum of squares of the fit.
    """

    pull_off_force: float
    strength: float
    sticks_below: float
    worst: float
    worst_at: float
    miss: float


def jkr_model(law: Law, force: float, *, viscoelastic: bool) -> DampedAdhesion:
    """LAMMPS' `jkr` with the pull-off force `force` (N); it parts at the largest tension.

    The damping is constant, or `viscoelastic`: proportional to the contact radius and the mass.
    """
    w = force / (1.5 * math.pi * law.radius)
    theory = JKR(law.radius, law.contact_modulus, w)
    least = float(theory.break_radius) * 3 ** (2 / 3)  # pull-off at fixed load: s³ = 3
    top = 3 * max(
        float(law.column("indentation").max()), float(theory.break_radius) ** 2 / law.radius
    )
    a = np.linspace(least, least + math.sqrt(2 * top * law.radius), _NODES)
    damping = a * law.mass if viscoelastic else np.ones_like(a)
    return DampedAdhesion(
        np.asarray(theory.indentation_at_contact_radius(a)),
        np.asarray(theory.force_at_contact_radius(a)),
        damping,
        _critical(law) / float(np.interp(top / 3, a**2 / law.radius, damping)),
    )


def dmt_model(law: Law, force: float, *, viscoelastic: bool) -> DampedAdhesion:
    """LAMMPS' `dmt`, Hertz minus the pull-off force `force` (N) while the spheres overlap.

    Without damping it loses no energy. The damping is as in `jkr_model`.
    """
    hertz = Hertz(law.radius, law.contact_modulus)
    deepest = float(law.column("indentation").max())
    top = 3 * max(deepest, float(hertz.indentation(force)))
    depth = top * np.linspace(0, 1, _NODES) ** 2
    damping = np.sqrt(law.radius * depth) * law.mass if viscoelastic else np.ones_like(depth)
    scale = float(np.interp(deepest, depth, damping))
    return DampedAdhesion(depth, hertz.force(depth) - force, damping, _critical(law) / scale)


def area_slope(law: Law, force: float) -> float:
    """c (N/m) for which the least force of F = K δ^{3/2} − c δ (K of Hertz) is −`force` (N)."""
    stiffness = 4 / 3 * law.contact_modulus * math.sqrt(law.radius)
    return float((6.75 * force * stiffness**2) ** (1 / 3))


def area_model(law: Law, force: float, lowest: float) -> DampedAdhesion:
    """LIGGGHTS' `hertz` with `sjkr`, F = K δ^{3/2} − c δ, with the pull-off force `force` (N).

    The damping is 2 (5/6)^½ (2E*m*)^½ (R*δ)^¼ times the strength −ln e/(ln² e + π²)^½ of the
    coefficient of restitution e that is given to LIGGGHTS, `lowest` at least.
    """
    c = area_slope(law, force)
    top = 3 * max(float(law.column("indentation").max()), 6.75 * force / c)
    depth = top * np.linspace(0, 1, _NODES) ** 2
    scale = 2 * math.sqrt(5 / 6 * 2 * law.contact_modulus * law.mass)
    return DampedAdhesion(
        depth,
        Hertz(law.radius, law.contact_modulus).force(depth) - c * depth,
        scale * (law.radius * depth) ** 0.25,
        -math.log(lowest) / math.hypot(math.log(lowest), math.pi),
    )


def fit_damping(model: DampedAdhesion, law: Law, force: float) -> AdhesiveFit:
    """The damping with which `model`, with the pull-off force `force` (N), is closest to `law`."""
    from scipy.optimize import minimize_scalar

    V_s = law.sticks_below or 0.0
    low = max(law.lowest, 1.2 * V_s)
    above = np.geomspace(low, law.highest, _POINTS)
    near = [share * V_s for share in _NEAR if law.lowest <= share * V_s <= law.highest]
    V = np.array([*near, *above])
    e = law.restitution(V)
    weights = np.array([_WEIGHT] * len(near) + [1.0] * _POINTS)
    time = np.minimum(contact_time(law) * V**-0.2, adhesive_time(law, force))

    def miss(logarithm: float) -> float:
        strength = model.largest * math.exp(logarithm)
        off = model.restitution(V, law.mass, strength, time) - e
        return float(np.sum(weights * off**2))

    starts = np.append(np.log(_SEARCH), -16.0)
    best = min(starts.tolist(), key=miss)
    result = minimize_scalar(miss, bounds=(best - 0.8, min(best + 0.8, 0.0)), method="bounded",
                             options={"maxiter": 12, "xatol": 0.01})  # fmt: skip
    strength = model.largest * math.exp(result.x if result.fun < miss(best) else best)
    off = np.abs(model.restitution(above, law.mass, strength, time[len(near) :]) - e[len(near) :])
    k = int(off.argmax())
    return AdhesiveFit(
        pull_off_force=force,
        strength=strength,
        sticks_below=_sticks_below(
            lambda v, t: model.restitution(v, law.mass, strength, t), law, force
        ),
        miss=float(min(result.fun, miss(best))),
        worst=float(off[k]),
        worst_at=float(above[k]),
    )


def _sticks_below(restitution: Callable[[Array, Array], Array], law: Law, force: float) -> float:
    """The velocity (m/s) from which the model rebounds, among 80 from 0.3 of that of the law."""
    scale = law.sticks_below or law.lowest
    V = scale * np.geomspace(0.3, 3.0, 80)
    time = np.minimum(contact_time(law) * V**-0.2, adhesive_time(law, force))
    sticks = np.flatnonzero(restitution(V, time) == 0)
    if not sticks.size:
        return 0.0
    k = int(sticks[-1])
    return float(V[k] if k + 1 == V.size else math.sqrt(V[k] * V[k + 1]))


def _critical(law: Law) -> float:
    """Critical damping (kg/s) at the largest indentation of the law."""
    depth = float(law.column("indentation").max())
    return 2 * math.sqrt(2 * law.contact_modulus * math.sqrt(law.radius * depth) * law.mass)


def known_pull_off(law: Law, velocity: float) -> float:
    """The pull-off force (N) of `law` after an impact at `velocity` (m/s). Raises `CaseError`."""
    force = pull_off_force(law, velocity)
    if not force > 0:
        raise unknown_pull_off(law)
    return force


def require_adhesion(laws: Iterable[Law], code: str) -> None:
    """Raise `CaseError` if no law has adhesion; `code` is the name of the export without it."""
    if not any(law.work_of_adhesion > 0 for law in laws):
        raise CaseError(
            f"none of these pairs has adhesion (interface.work_of_adhesion); use --to {code}"
        )


def misfit(fit: AdhesiveFit, law: Law) -> str:
    """How far the fit of `law` is off, in one sentence."""
    if law.sticks_everywhere:
        known = f"sticks up to {law.highest:.3g} m/s at least"
    elif law.sticks_below is None:
        known = f"never sticks from {law.lowest:.3g} m/s on"
    else:
        known = f"sticks below {law.sticks_below:.3g} m/s"
    return (
        f"pull-off force {fit.pull_off_force:.4g} N as computed; sticks below "
        f"{fit.sticks_below:.3g} m/s (the law {known}); above, e is off by up to {fit.worst:.2g} "
        f"(at {fit.worst_at:.3g} m/s)"
    )
