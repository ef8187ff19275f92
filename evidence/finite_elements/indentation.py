"""Loading and unloading one mesh: contact as constraints, Newton's method, curves and works."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from elements import element_pass, element_pass_finite, strain_matrices
from factor import Factor
from problem import MeshSpec, Model, graded_coordinates, hemisphere
from scipy.sparse import csr_matrix

_NEWTON_TOLERANCE = 1e-6  # residual over contact force
_MAX_ITERATIONS = 40
_FREE_SET_ITERATIONS = 14  # later iterations change one contact node at a time
UNLOADING_FORCE_STEP = 0.045  # drop of force per step over the largest force
_UNLOADING_MAX_STEPS = 90
_FINITE = ("finite", "flattening", "finite-hemisphere")
_FLAT = ("flattening", "hemisphere", "finite-hemisphere")  # the body has the profile
_KINEMATICS = ("small", "deformed-contact", *dict.fromkeys(_FINITE + _FLAT))


class State(NamedTuple):
    """One equilibrium.

    Args:
        indentation: approach of the rigid body since first touch (m).
        u: displacements, r and z of each node in turn (m).
        tensor: plastic strains (small strains) or Cauchy stresses in Pa (finite strains).
        equivalent_plastic_strain: one value per integration point.
        active: nodes in contact, among the candidates.
        force: contact force (N).
        iterations: Newton iterations of the last step.
    """

    indentation: float
    u: np.ndarray
    tensor: np.ndarray
    equivalent_plastic_strain: np.ndarray
    active: np.ndarray
    force: float
    iterations: int = 0


@dataclass
class Curve:
    """Points of a path: indentation (m), force (N), contact area (m²) and its two bounds."""

    indentation: list[float] = field(default_factory=list)
    force: list[float] = field(default_factory=list)
    area: list[float] = field(default_factory=list)
    area_inner: list[float] = field(default_factory=list)
    area_outer: list[float] = field(default_factory=list)


class Indentation:
    """Finite element model of one profile on one mesh.

    Args:
        model: material and profile.
        spec: mesh.
        kinematics: "small" (small strains, gap at the undeformed radius), "deformed-contact"
            (small strains, gap and normal at the deformed radius), "finite" (finite strains,
            gap and normal at the deformed radius), "flattening" (finite strains, the body has
            the profile and the rigid surface is flat), or "hemisphere" and "finite-hemisphere"
            (small and finite strains; the body is a hemisphere whose equator stays plane, and the
            rigid surface is flat).
    """

    def __init__(self, model: Model, spec: MeshSpec, kinematics: str = "small"):
        if kinematics not in _KINEMATICS:
            raise ValueError(f"unknown kinematics {kinematics!r}")
        self.model, self.spec, self.kinematics = model, spec, kinematics
        E, nu = model.youngs_modulus, model.poissons_ratio
        self.G, self.bulk = E / (2 * (1 + nu)), E / (3 * (1 - 2 * nu))
        x = graded_coordinates(spec, spec.uniform_radius, spec.grading_r)
        y = graded_coordinates(spec, spec.uniform_depth, spec.grading_z)
        nr, nz = len(x), len(y)
        r, z = (c.ravel() for c in np.meshgrid(x, y, indexing="ij"))
        i, j = (c.ravel() for c in np.meshgrid(range(nr - 1), range(nz - 1), indexing="ij"))
        first = i * nz + j
        conn = np.stack([first, first + nz, first + nz + 1, first + 1], axis=1)
        self.surface_r = x
        self.surface_dof = 2 * nz * np.arange(nr) + 1
        self.candidates = self.surface_dof[:-1]
        shift = np.zeros_like(r)
        if kinematics == "flattening":
            # The profile ends in a plane outside 1.4 times the finely meshed radius.
            limit, decay = 1.4 * spec.uniform_radius, 2 * spec.uniform_radius
            inner = np.minimum(r, limit)
            slope = model.profile_slopes(np.array([limit]))[0][0]
            shift = model.profile(inner) + slope * decay * (1 - np.exp((inner - r) / decay))
            shift = shift * np.exp(-z / (4 * spec.uniform_radius))
        bottom = z == y[-1]
        if kinematics.endswith("hemisphere"):
            r, z = hemisphere(r / x[-1], z / y[-1], model.radius)
        self.coordinates = np.stack([r, z + shift], axis=1).ravel()
        self.ndof, self.conn, self.elements = 2 * nr * nz, conn, len(conn)
        self.B = np.empty((self.elements, 4, 4, 8))
        self.w = np.empty((self.elements, 4))
        strain_matrices(r, z, conn, self.B, self.w)

        dofs = np.stack([2 * conn, 2 * conn + 1], axis=2).reshape(-1, 8)
        rows, cols = np.repeat(dofs, 8, axis=1), np.tile(dofs, (1, 8))
        keys = np.minimum(rows, cols).astype(np.int64) * self.ndof + np.maximum(rows, cols)
        unique, inverse = np.unique(keys.ravel(), return_inverse=True)
        self.kmap = inverse.reshape(self.elements, 8, 8).astype(np.int64)
        self.rows, self.cols = unique // self.ndof, (unique % self.ndof).astype(np.int32)
        self.indptr = np.searchsorted(self.rows, np.arange(self.ndof + 1)).astype(np.int32)
        self.diagonal = np.flatnonzero(self.rows == self.cols)  # one per row, in order
        self.kdata = np.empty(len(unique))
        self.factor = Factor(self.indptr, self.cols)

        axis = 2 * np.flatnonzero(r == 0)
        far = np.flatnonzero((r == x[-1]) | (z == y[-1]))
        rho = np.hypot(r[far], z[far])
        # Johnson (1985), eq. (3.18): displacements by a unit force on a half-space
        scale = (1 + nu) / (2 * np.pi * E * rho)
        u_r = scale * (r[far] * z[far] / rho**2 - (1 - 2 * nu) * r[far] / (rho + z[far]))
        u_z = scale * (z[far] ** 2 / rho**2 + 2 * (1 - nu))
        self.per_force = np.zeros(self.ndof)
        self.per_force[2 * far], self.per_force[2 * far + 1] = u_r, u_z
        self.fixed = np.zeros(self.ndof, bool)
        if kinematics.endswith("hemisphere"):
            self.per_force[:], far = 0.0, np.array([], int)
            self.fixed[2 * np.flatnonzero(bottom) + 1] = True
            self.surface_r = r[self.surface_dof // 2]
        self.fixed[axis] = self.fixed[2 * far] = self.fixed[2 * far + 1] = True
        self.per_force[axis] = 0.0

    def start(self) -> State:
        """Return the undeformed state."""
        shape = (self.elements, 4)
        return State(
            0.0,
            np.zeros(self.ndof),
            np.zeros((*shape, 4)),
            np.zeros(shape),
            np.zeros(len(self.candidates), bool),
            0.0,
        )

    def _gap_profile(self, u):
        """Return g (m), g' and g'' (1/m) at the candidate nodes; derivatives 0 where unused."""
        r = self.surface_r[:-1]
        if self.kinematics == "small":
            return self.model.profile(r), np.zeros_like(r), np.zeros_like(r)
        if self.kinematics in _FLAT:
            return self.coordinates[self.candidates], np.zeros_like(r), np.zeros_like(r)
        r = r + u[self.candidates - 1]
        return (self.model.profile(r), *self.model.profile_slopes(r))

    def _evaluate(self, state, u, slope, tensor, al, f):
        """Fill the material state, the forces `f` and the tangent at displacements `u`."""
        m = self.model
        strength = 1e30 if m.yield_strength is None else m.yield_strength
        node_slope = np.zeros(self.ndof // 2)
        node_slope[self.candidates // 2] = slope
        material = (
            self.G,
            self.bulk,
            strength,
            m.hardening_modulus,
            m.hardening_exponent,
            m.youngs_modulus,
            self.kmap,
            node_slope,
            tensor,
            al,
            f,
            self.kdata,
        )
        old = state.tensor, state.equivalent_plastic_strain
        if self.kinematics in _FINITE:
            element_pass_finite(u, state.u, self.coordinates, self.conn, *old, *material)
        else:
            element_pass(u, self.B, self.w, self.conn, *old, *material)

    def _product(self, x):
        A = csr_matrix((self.kdata, self.cols, self.indptr), shape=(self.ndof, self.ndof))
        return A @ x + A.T @ x - self.kdata[self.diagonal] * x

    def advance(
        self,
        state: State,
        indentation: float,
        guess: np.ndarray | None = None,
        careful: bool = False,
    ) -> State:
        """Return the equilibrium at an indentation (m), after the converged `state`.

        Semismooth Newton: plasticity and the set of contact nodes change together.

        Args:
            state: last converged equilibrium.
            indentation: approach of the rigid body since first touch (m).
            guess: starting displacements (m); None: those of `state`.
            careful: change the contact only once plasticity has nearly converged, and limit steps.
        """
        longest = 2 * abs(indentation - state.indentation)
        u = (state.u if guess is None else guess).copy()
        profile, slope, curvature = self._gap_profile(u)
        target = indentation - profile
        if guess is None and state.force == 0.0:
            active = target > u[self.candidates]
        else:
            active = state.active.copy()
        tensor, al = np.empty_like(state.tensor), np.empty_like(state.equivalent_plastic_strain)
        f = np.empty(self.ndof)
        changed, last_du, last_norm, fraction = True, None, 0.0, 1.0
        for iteration in range(_MAX_ITERATIONS * (3 if careful else 1)):
            self._evaluate(state, u, slope, tensor, al, f)
            nodes = self.candidates[active]
            force = f[nodes].sum()
            self.kdata[self.diagonal[nodes - 1]] -= curvature[active] * f[nodes]
            held = self.fixed.copy()
            held[nodes] = True
            du = np.zeros(self.ndof)
            du[self.fixed] = max(force, 0.0) * self.per_force[self.fixed] - u[self.fixed]
            du[nodes] = target[active] - u[nodes]
            free = ~held
            norm = np.linalg.norm(f[free])
            if last_du is not None and not norm < last_norm and fraction > 1 / 64:
                # The full step increased the residual of the same contact: take half of it.
                fraction /= 2
                u -= fraction * last_du
                profile, slope, curvature = self._gap_profile(u)
                target = indentation - profile
                continue
            scale = max(abs(force), 1e-3 * abs(state.force), 1e-300)
            residual = norm / scale
            if not residual < 1e8:
                break
            mismatch = np.abs(du).max() / indentation if indentation else 0.0
            if not changed and residual < _NEWTON_TOLERANCE and mismatch < 1e-6:
                return State(indentation, u, tensor, al, active, float(force), iteration)
            b = -f - self._product(du)
            b[held] = du[held]
            keep = free[self.rows] & free[self.cols]
            data = np.where(keep, self.kdata, 0.0)
            data[self.diagonal[held]] = 1.0
            du = self.factor.solve(data, b)
            if not np.isfinite(du).all():
                break
            reaction = (f + self._product(du))[self.candidates]
            du[self.candidates] -= slope * du[self.candidates - 1]
            if careful:
                du *= min(1.0, longest / max(np.abs(du).max(), 1e-300))
            u += du
            profile, slope, curvature = self._gap_profile(u)
            target = indentation - profile
            overlap = target - u[self.candidates]
            leave = active & (reaction < 0)
            enter = ~active & (overlap > 1e-9 * abs(indentation))
            if careful and residual > 1e-3 and iteration:
                leave[:] = enter[:] = False
            if iteration >= (3 if careful else 1) * _FREE_SET_ITERATIONS:
                for flags, size in ((leave, -reaction), (enter, overlap)):
                    worst = np.argmax(np.where(flags, size, -np.inf))
                    keep_one = flags[worst]
                    flags[:] = False
                    flags[worst] = keep_one
                if enter.any():
                    leave[:] = False
            waits = careful and residual > 1e-3
            changed = bool(leave.any() or enter.any() or waits)
            active = (active & ~leave) | enter
            settled = (
                (not changed or waits) and mismatch < 1e-6 and residual > 10 * _NEWTON_TOLERANCE
            )
            last_du, last_norm, fraction = (du if settled else None), norm, 1.0
        raise RuntimeError(f"no equilibrium at {indentation:g} m (residual {residual:.1e})")

    def areas(self, state: State) -> tuple[float, float, float]:
        """Return the contact area (m²), and its bounds from the last and the first free node.

        The gap beside an elastic contact edge grows as distance^(3/2). A line through gap^(2/3) of
        the two nearest free nodes gives the edge, limited to the element that holds it.
        """
        x, active = self.surface_r[:-1], state.active
        if self.kinematics not in ("small", "hemisphere"):
            x = x + state.u[self.candidates - 1]
        profile = self._gap_profile(state.u)[0]
        gap = np.maximum(state.u[self.candidates] + profile - state.indentation, 0.0) ** (2 / 3)
        total = np.zeros(3)
        switch = np.flatnonzero(active[1:] != active[:-1])
        for k in switch:
            outward = active[k]
            inside, out, beyond = (k, k + 1, k + 2) if outward else (k + 1, k, k - 1)
            edge = 0.5 * (x[inside] + x[out])
            if 0 <= beyond < len(x) and not active[beyond] and gap[beyond] > gap[out] > 0:
                edge = (x[out] * gap[beyond] - x[beyond] * gap[out]) / (gap[beyond] - gap[out])
                edge = np.clip(edge, *sorted((x[inside], x[out])))
            sign = 1 if outward else -1
            total += sign * np.pi * np.array([edge, x[inside], x[out]]) ** 2
        return tuple(total)

    def _record(self, curve: Curve, state: State) -> None:
        area = self.areas(state)
        curve.indentation.append(state.indentation)
        curve.force.append(state.force)
        for name, value in zip(("area", "area_inner", "area_outer"), area, strict=True):
            getattr(curve, name).append(float(value))

    def load(self, indentations, stops, report=None) -> tuple[Curve, dict[int, State]]:
        """Load through the indentations (m); keep the states at the indices `stops`."""
        state, last, curve, kept = self.start(), None, Curve(), {}
        for k, depth in enumerate(indentations):
            guess = None
            if last is not None and last.force > 0:
                ratio = (depth - state.indentation) / (state.indentation - last.indentation)
                guess = state.u + ratio * (state.u - last.u)
            try:
                new = self.advance(state, depth, guess)
            except RuntimeError:
                new = self._advance_halved(state, depth)
            last, state = state, new
            self._record(curve, state)
            if k in stops:
                kept[k] = state
            if report:
                report(state)
        return curve, kept

    def _advance_halved(self, state, depth, levels=4):
        try:
            return self.advance(state, depth, careful=True)
        except RuntimeError:
            if not levels:
                raise
            middle = self._advance_halved(state, 0.5 * (state.indentation + depth), levels - 1)
            return self._advance_halved(middle, depth, levels - 1)

    def unload(self, state: State, force_step: float = UNLOADING_FORCE_STEP) -> Curve:
        """Unload from a state to zero force; the last point is the residual indentation.

        Args:
            state: loaded equilibrium.
            force_step: largest drop of force per step, over the force of `state`.
        """
        curve, peak, last = Curve(), state.force, None
        self._record(curve, state)
        stiffness = 2 * self.model.contact_modulus * np.sqrt(curve.area[0] / np.pi)
        recovery = 1.5 * peak / stiffness
        step = 0.5 * force_step * peak / stiffness
        for _ in range(_UNLOADING_MAX_STEPS):
            depth = state.indentation - step
            guess = None
            if last is not None:
                ratio = step / (last.indentation - state.indentation)
                guess = state.u + ratio * (state.u - last.u)
            try:
                new = self.advance(state, depth, guess)
            except RuntimeError:
                new = self._advance_halved(state, depth)
            if not new.active.any() or new.force <= 0:
                residual = float((new.u[self.candidates] + self._gap_profile(new.u)[0]).min())
                residual = min(max(residual, depth), state.indentation)
                curve.indentation.append(residual)
                for values in (curve.force, curve.area, curve.area_inner, curve.area_outer):
                    values.append(0.0)
                return curve
            slope = (state.force - new.force) / step
            last, state = state, new
            self._record(curve, state)
            wanted = force_step * peak / max(slope, 1e-300)
            step = min(wanted, 1.5 * step, force_step * recovery)
        raise RuntimeError("unloading took too many steps")

    def close(self) -> None:
        """Free the memory of the factorisation."""
        self.factor.close()
