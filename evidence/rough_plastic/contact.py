"""One contact in 3D with Tamaas: force steps, periodic corrections, and what a step changes.

Tamaas provides the volume integral operators, the J2 material and the elastic contact solver. Here
contact and plasticity are solved together for every force step by Anderson acceleration of the
strain increment, which needs about ten times fewer operator evaluations than the nested fixed point
of tamaas.EPICSolver (`epic` uses that one, for comparison).

Units: micrometre, MPa, hence micronewton.
"""

import numpy as np
import tamaas as tm
import tamaas.materials
from tamaas.nonlinear_solvers import DFSANECXXSolver

tm.set_log_level(tm.LogLevel.error)

# Lattice sums of the square lattice: the sum of 1/|R| over all R but the
# origin with a neutralising background, and the plain sum of 1/|R|^3.
LATTICE_1 = -3.900264920
LATTICE_3 = 9.033621683


class State:
    """Everything that a force step changes."""

    NAMES = (
        "strain",
        "plastic_strain",
        "cumulated_plastic_strain",
        "stress",
        "traction",
        "displacement",
    )

    def __init__(self, solver):
        model = solver.model
        self.fields = {k: np.array(model[k]) for k in self.NAMES}
        self.plastic = solver.plastic_displacement.copy()
        self.guess = solver.guess.copy()
        self.force = solver.force
        self.last = solver.last_step

    def restore(self, solver):
        for k, v in self.fields.items():
            solver.model[k][...] = v
        solver.plastic_displacement = self.plastic.copy()
        solver.guess = self.guess.copy()
        solver.force = self.force
        solver.last_step = self.last


class Contact:
    """Rigid surface on an elastic-plastic half-space."""

    def __init__(
        self,
        heights,
        length,
        depth,
        layers,
        modulus,
        poisson,
        yield_strength,
        radius,
        hardening=0.0,
        elastic=False,
        images=True,
        tolerance=1e-4,
        epic=False,
    ):
        n = heights.shape[0]
        self.n, self.length, self.layers = n, length, layers
        self.depth = depth
        self.cell = length / n
        self.model = tm.ModelFactory.createModel(
            tm.model_type.volume_2d, [depth, length, length], [layers, n, n]
        )
        self.model.E, self.model.nu = modulus, poisson
        self.poisson, self.modulus = poisson, modulus
        self.reduced = modulus / (1 - poisson**2)
        self.material = tm.materials.IsotropicHardening(self.model, yield_strength, hardening)
        self.residual = tm.Residual(self.model, self.material)
        x = (np.arange(n) - n // 2) * self.cell
        self.r2 = x[:, None] ** 2 + x[None, :] ** 2
        self.heights = heights
        self.surface = heights - self.r2 / (2 * radius)  # gap is minus this
        self.work = self.surface.copy()  # the contact solver keeps a reference
        self.contact = tm.PolonskyKeerRey(self.model, self.work, 1e-11)
        self.contact.max_iter = 3000
        self.elastic, self.images, self.tolerance = elastic, images, tolerance
        self.plastic_displacement = np.zeros((n, n))
        self.guess = np.zeros((layers, n, n, 6))
        self.force, self.last_step = 0.0, 0.0
        q = 2 * np.pi * np.fft.fftfreq(n, self.cell)
        q = np.hypot(q[:, None], q[None, :])
        self.compliance = np.where(q > 0, 2 / (self.reduced * np.where(q > 0, q, 1)), 0)
        self.evaluations = 0
        self.epic = None
        if epic:
            self.inner = DFSANECXXSolver(self.residual)
            self.inner.tolerance = 1e-9
            self.epic = tm.AndersonMixing(self.contact, self.inner, 1e-8, 5)

    # The periodic images lower the surface near the centre by
    # -LATTICE_1 F/(pi E* L) - LATTICE_3 F r^2/(4 pi E* L^3): the first is
    # added to the approach, the second to the shape of the surface.
    def kappa(self):
        return -LATTICE_1 / (np.pi * self.reduced * self.length)

    def image_shape(self, force):
        if not self.images:
            return 0.0
        return (LATTICE_3 * force / (4 * np.pi * self.reduced * self.length**3)) * self.r2

    def image_strain(self, dforce):
        """Strain that turns that of the periodic array into one contact's.

        The mean mode of the volume operators is the uniaxial one, with stress
        -F/L^2 (nu/(1 - nu), nu/(1 - nu), 1).  The limit of the other modes
        for vanishing wave number, averaged over the directions, is
        -F/L^2 (1/2 + nu, 1/2 + nu, 1), and the images then add, to first
        order in the depth z, -LATTICE_3 (1 + nu) F z/(2 pi L^3) (1, 1, 0).
        """
        out = np.zeros((self.layers, 1, 1, 6))
        if self.images:
            nu, length = self.poisson, self.length
            z = np.linspace(0, self.depth, self.layers)
            s = (
                dforce
                / length**2
                * (nu / (1 - nu) - 0.5 - nu + LATTICE_3 * (1 + nu) * z / (2 * np.pi * length))
            )
            out[:, 0, 0, 0] = out[:, 0, 0, 1] = (1 - nu) * s / self.modulus
            out[:, 0, 0, 2] = -2 * nu * s / self.modulus
        return out

    def pressure(self):
        return np.array(self.model.traction)[..., 2]

    def elastic_displacement(self):
        return np.fft.ifft2(np.fft.fft2(self.pressure()) * self.compliance).real

    def solve_contact(self, force, traction, plastic):
        self.model.traction[...] = traction
        self.work[...] = self.surface + self.image_shape(force) - plastic
        self.contact.solve(force / self.length**2)
        return np.array(self.model.traction)

    def step(self, force, memory=10, max_iter=300):
        """Advance to a total force; returns the number of iterations."""
        model, res = self.model, self.residual
        if self.epic is not None:
            self.work[...] = self.surface - self.plastic_displacement
            self.epic.solve(force / self.length**2)
            self.plastic_displacement = self.surface - self.work
            self.force = force
            return 0
        t0 = np.array(model.traction)
        df = force - self.force
        scale = df / self.last_step if self.last_step * df > 0 else 0.0
        x = self.guess * scale
        offset = self.image_strain(df)
        xs, rs = [], []
        t = t0.copy()
        for it in range(max_iter):  # noqa: B007
            if self.elastic:
                increment = 0.0
            else:
                res.computeResidualDisplacement(x)
                increment = np.array(model.displacement)[0, ..., 2]
            t = self.solve_contact(force, t, self.plastic_displacement + increment)
            if self.elastic:
                break
            model.traction[...] = t - t0
            res.computeResidual(x)
            self.evaluations += 1
            r = np.array(res.vector).reshape(x.shape) + offset
            norm = np.linalg.norm(r)
            ref = np.linalg.norm(x)
            if norm <= self.tolerance * ref:
                break
            if xs:
                dx = [x - xs[-1]]
                dr = [r - rs[-1]]
            xs.append(x)
            rs.append(r)
            if len(xs) > 1:
                self._hx.append(dx[0].ravel())
                self._hr.append(dr[0].ravel())
                if len(self._hx) > memory:
                    self._hx.pop(0)
                    self._hr.pop(0)
                    self._gram = self._gram[1:, 1:]
                m = len(self._hr)
                g = np.zeros((m, m))
                g[: m - 1, : m - 1] = self._gram
                col = np.array([h @ self._hr[-1] for h in self._hr])
                g[m - 1, :] = g[:, m - 1] = col
                self._gram = g
                rhs = np.array([h @ r.ravel() for h in self._hr])
                d = np.sqrt(np.diag(g))
                gamma = np.linalg.lstsq(g / np.outer(d, d), rhs / d, rcond=1e-12)[0] / d
                new = (x + r).ravel()
                for c, hx, hr in zip(gamma, self._hx, self._hr, strict=True):
                    new = new - c * (hx + hr)
                new = new.reshape(x.shape)
            else:
                self._hx, self._hr, self._gram = [], [], np.zeros((0, 0))
                new = x + r
            xs, rs = xs[-1:], rs[-1:]
            x = new
        else:
            raise RuntimeError(f"no convergence at {force}: {norm / ref:.2e}")
        model.traction[...] = t
        if not self.elastic:
            res.updateState(x)
            self.plastic_displacement = self.plastic_displacement + increment
            model.traction[...] = t
            self.guess, self.last_step = x, df
        self.force = force
        return it + 1

    def approach(self):
        """Rigid approach, corrected for the periodic images."""
        shape = self.surface + self.image_shape(self.force) - self.plastic_displacement
        if self.force == 0:
            return -shape.max()
        p = self.pressure()
        gap = self.elastic_displacement() - shape
        return np.sum(gap * p) / np.sum(p) + self.kappa() * self.force

    def area(self):
        return np.count_nonzero(self.pressure() > 0) * self.cell**2

    def plastic_strain(self):
        return np.array(self.model["cumulated_plastic_strain"])
