"""Axisymmetric finite elements for elastic-plastic contact with a rigid profile.

A deformable half-space (J2 plasticity, small strains) is pressed by a rigid frictionless body with
the gap profile g(r) = r²/(2R) + A (1 − cos(2πr/λ)). README.md gives equations and sources.

Example:
    python solve.py --yield-strength 1e9 --youngs-modulus 210e9 --poissons-ratio 0.3 --omega 2 4 8
"""

from __future__ import annotations

import argparse
import json
import os
import time
from dataclasses import dataclass, field
from typing import NamedTuple

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import numba as nb  # noqa: E402
import numpy as np  # noqa: E402
import scipy  # noqa: E402
from scipy.interpolate import PchipInterpolator  # noqa: E402
from scipy.sparse import csc_matrix, csr_matrix  # noqa: E402
from scipy.sparse.linalg import splu  # noqa: E402

try:
    from pypardiso import PyPardisoSolver
    from pypardiso.pardiso_wrapper import PyPardisoError
except ImportError:  # SuperLU does the same, but more slowly
    PyPardisoSolver = None
    PyPardisoError = RuntimeError

_NEWTON_TOLERANCE = 1e-6  # residual over contact force
_MAX_ITERATIONS = 40
_FREE_SET_ITERATIONS = 14  # later iterations change one contact node at a time
_UNLOADING_FORCE_STEP = 0.045  # drop of force per step over the largest force
_UNLOADING_MAX_STEPS = 90


@dataclass(frozen=True)
class Model:
    """Deformable half-space and rigid profile.

    Args:
        youngs_modulus: Young's modulus E (Pa).
        poissons_ratio: Poisson's ratio ν.
        yield_strength: initial uniaxial yield strength S_y (Pa); None: elastic.
        hardening_modulus: slope dσ/dε_p of linear isotropic hardening (Pa).
        hardening_exponent: exponent n of σ = S_y (1 + E ε_p/S_y)^n; 0: linear hardening.
        radius: radius R of the rigid parabola (m).
        wave_amplitude: amplitude A of concentric waves (m).
        wavelength: wavelength λ of the waves (m).
    """

    youngs_modulus: float = 210e9
    poissons_ratio: float = 0.3
    yield_strength: float | None = 1e9
    hardening_modulus: float = 0.0
    hardening_exponent: float = 0.0
    radius: float = 500e-6
    wave_amplitude: float = 0.0
    wavelength: float = 0.0

    @property
    def contact_modulus(self) -> float:
        """Contact modulus E* = E/(1 − ν²) (Pa)."""
        return self.youngs_modulus / (1 - self.poissons_ratio**2)

    @property
    def critical_indentation(self) -> float:
        """Indentation δ_c at first yield of the smooth sphere (m), Jackson and Green (2005)."""
        strength = 1e9 if self.yield_strength is None else self.yield_strength
        c = 1.295 * np.exp(0.736 * self.poissons_ratio)
        return (np.pi * c * strength / (2 * self.contact_modulus)) ** 2 * self.radius

    def profile(self, r: np.ndarray) -> np.ndarray:
        """Gap g(r) of the undeformed surfaces at first touch (m) at radii r (m)."""
        g = r**2 / (2 * self.radius)
        if self.wave_amplitude:
            g = g + self.wave_amplitude * (1 - np.cos(2 * np.pi * r / self.wavelength))
        return g

    def profile_slopes(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return g'(r) (-) and g''(r) (1/m) at radii r (m)."""
        first, second = r / self.radius, np.full_like(r, 1 / self.radius)
        if self.wave_amplitude:
            k = 2 * np.pi / self.wavelength
            first = first + self.wave_amplitude * k * np.sin(k * r)
            second = second + self.wave_amplitude * k**2 * np.cos(k * r)
        return first, second

    @property
    def crest_radius(self) -> float:
        """Radius of curvature of the profile at r = 0 (m)."""
        curvature = 1 / self.radius
        if self.wave_amplitude:
            curvature += self.wave_amplitude * (2 * np.pi / self.wavelength) ** 2
        return 1 / curvature


@dataclass(frozen=True)
class MeshSpec:
    """Tensor-product mesh: uniform near the contact, then two geometric gradings.

    Args:
        element_size: edge of the elements below the contact (m).
        uniform_radius: radius to which elements keep this width (m).
        uniform_depth: depth to which elements keep this height (m).
        fine_extent: radius and depth to which the first grading goes (m).
        domain: radius and depth of the domain (m).
        grading_r: ratio of neighbouring widths in the first grading.
        grading_z: ratio of neighbouring heights in the first grading.
        grading_far: ratio of neighbouring sizes in the second grading.
    """

    element_size: float
    uniform_radius: float
    uniform_depth: float
    fine_extent: float
    domain: float
    grading_r: float = 1.10
    grading_z: float = 1.06
    grading_far: float = 1.25


def graded_coordinates(spec: MeshSpec, uniform: float, grading: float) -> np.ndarray:
    """Return node coordinates (m) along one axis: uniform, graded, then graded faster."""
    h = spec.element_size
    x = list(np.arange(round(uniform / h) + 1) * h)
    while x[-1] < spec.domain:
        h *= grading if x[-1] < spec.fine_extent else spec.grading_far
        x.append(x[-1] + h)
    return np.array(x)


@nb.njit(cache=True, error_model="numpy")
def _strain_matrices(r, z, conn, B, w):
    g = 1 / np.sqrt(3.0)
    xi = np.array([-g, g, g, -g])
    eta = np.array([-g, -g, g, g])
    sx = np.array([-1.0, 1.0, 1.0, -1.0])
    sy = np.array([-1.0, -1.0, 1.0, 1.0])
    for e in range(conn.shape[0]):
        vol = np.zeros((4, 8))
        mean = np.zeros(8)
        total = 0.0
        for p in range(4):
            a = b = c = d = radius = 0.0
            dx = np.empty(4)
            dy = np.empty(4)
            N = np.empty(4)
            for i in range(4):
                N[i] = 0.25 * (1 + sx[i] * xi[p]) * (1 + sy[i] * eta[p])
                dx[i] = 0.25 * sx[i] * (1 + sy[i] * eta[p])
                dy[i] = 0.25 * sy[i] * (1 + sx[i] * xi[p])
                n = conn[e, i]
                a += dx[i] * r[n]
                b += dx[i] * z[n]
                c += dy[i] * r[n]
                d += dy[i] * z[n]
                radius += N[i] * r[n]
            det = a * d - b * c
            w[e, p] = 2 * np.pi * radius * det
            for i in range(4):
                nr = (d * dx[i] - b * dy[i]) / det
                nz = (-c * dx[i] + a * dy[i]) / det
                B[e, p, :, 2 * i] = 0.0
                B[e, p, :, 2 * i + 1] = 0.0
                B[e, p, 0, 2 * i] = nr
                B[e, p, 1, 2 * i + 1] = nz
                B[e, p, 2, 2 * i] = N[i] / radius
                B[e, p, 3, 2 * i] = nz
                B[e, p, 3, 2 * i + 1] = nr
            for k in range(8):
                vol[p, k] = B[e, p, 0, k] + B[e, p, 1, k] + B[e, p, 2, k]
                mean[k] += w[e, p] * vol[p, k]
            total += w[e, p]
        for p in range(4):
            for k in range(8):
                change = (mean[k] / total - vol[p, k]) / 3
                for m in range(3):
                    B[e, p, m, k] += change


@nb.njit(cache=True, error_model="numpy")
def _flow_stress(alpha, strength, H, n, E):
    if n == 0.0:
        return strength + H * alpha, H
    base = 1 + E * alpha / strength
    return strength * base**n, n * E * base ** (n - 1)


@nb.njit(cache=True, error_model="numpy")
def _assemble(Ke, fe, conn_e, slope, dofs, kmap_e, f, kdata):
    """Add one element; surface nodes use u_z + g' u_r in place of u_z."""
    for i in range(4):
        t = slope[conn_e[i]]
        if t != 0.0:
            for j in range(8):
                for k in range(j):
                    Ke[j, k] = Ke[k, j]
            for k in range(8):
                Ke[2 * i, k] -= t * Ke[2 * i + 1, k]
            for k in range(8):
                Ke[k, 2 * i] -= t * Ke[k, 2 * i + 1]
            fe[2 * i] -= t * fe[2 * i + 1]
    for j in range(8):
        f[dofs[j]] += fe[j]
        for k in range(j, 8):
            kdata[kmap_e[j, k]] += Ke[j, k]


@nb.njit(cache=True, error_model="numpy")
def _element_pass(
    u, B, w, conn, ep_old, al_old, G, bulk, strength, H, n, E, kmap, slope, ep, al, f, kdata
):
    """Return map every point; fill internal forces `f` and the upper triangle `kdata`."""
    f[:] = 0.0
    kdata[:] = 0.0
    ue = np.empty(8)
    dofs = np.empty(8, np.int64)
    D = np.empty((4, 4))
    DB = np.empty((4, 8))
    Ke = np.empty((8, 8))
    fe = np.empty(8)
    s = np.empty(4)
    nv = np.empty(4)
    for e in range(conn.shape[0]):
        for i in range(4):
            dofs[2 * i] = 2 * conn[e, i]
            dofs[2 * i + 1] = 2 * conn[e, i] + 1
        for k in range(8):
            ue[k] = u[dofs[k]]
        Ke[:] = 0.0
        fe[:] = 0.0
        for p in range(4):
            e0 = e1 = e2 = e3 = 0.0
            for k in range(8):
                e0 += B[e, p, 0, k] * ue[k]
                e1 += B[e, p, 1, k] * ue[k]
                e2 += B[e, p, 2, k] * ue[k]
                e3 += B[e, p, 3, k] * ue[k]
            tr = e0 + e1 + e2
            s[0] = 2 * G * (e0 - tr / 3 - ep_old[e, p, 0])
            s[1] = 2 * G * (e1 - tr / 3 - ep_old[e, p, 1])
            s[2] = 2 * G * (e2 - tr / 3 - ep_old[e, p, 2])
            s[3] = G * (e3 - ep_old[e, p, 3])
            norm = np.sqrt(s[0] ** 2 + s[1] ** 2 + s[2] ** 2 + 2 * s[3] ** 2)
            q = np.sqrt(1.5) * norm
            a0 = al_old[e, p]
            sy, hard = _flow_stress(a0, strength, H, n, E)
            theta = 1.0
            theta_n = 0.0
            for m in range(4):
                ep[e, p, m] = ep_old[e, p, m]
            al[e, p] = a0
            if q > sy * (1 + 1e-10):
                dg = (q - sy) / (3 * G + hard)
                if n != 0.0:
                    for _ in range(30):
                        sy, hard = _flow_stress(a0 + dg, strength, H, n, E)
                        step = (q - 3 * G * dg - sy) / (3 * G + hard)
                        dg += step
                        if abs(step) < 1e-14:
                            break
                    sy, hard = _flow_stress(a0 + dg, strength, H, n, E)
                theta = 1 - 3 * G * dg / q
                theta_n = 3 * G / (3 * G + hard) - (1 - theta)
                c = 1.5 * dg / q
                for m in range(3):
                    ep[e, p, m] += c * s[m]
                ep[e, p, 3] += 2 * c * s[3]
                al[e, p] = a0 + dg
                for m in range(4):
                    nv[m] = s[m] / norm
                    s[m] *= theta
            pressure = bulk * tr
            wp = w[e, p]
            for k in range(8):
                fe[k] += wp * (
                    B[e, p, 0, k] * (s[0] + pressure)
                    + B[e, p, 1, k] * (s[1] + pressure)
                    + B[e, p, 2, k] * (s[2] + pressure)
                    + B[e, p, 3, k] * s[3]
                )
            g2 = 2 * G * theta
            for i in range(4):
                for j in range(4):
                    D[i, j] = 0.0
            for i in range(3):
                for j in range(3):
                    D[i, j] = bulk - g2 / 3
                D[i, i] += g2
            D[3, 3] = g2 / 2
            if theta_n != 0.0:
                for i in range(4):
                    for j in range(4):
                        D[i, j] -= 2 * G * theta_n * nv[i] * nv[j]
            for i in range(4):
                for k in range(8):
                    DB[i, k] = wp * (
                        D[i, 0] * B[e, p, 0, k]
                        + D[i, 1] * B[e, p, 1, k]
                        + D[i, 2] * B[e, p, 2, k]
                        + D[i, 3] * B[e, p, 3, k]
                    )
            for j in range(8):
                for k in range(j, 8):
                    Ke[j, k] += (
                        B[e, p, 0, j] * DB[0, k]
                        + B[e, p, 1, j] * DB[1, k]
                        + B[e, p, 2, j] * DB[2, k]
                        + B[e, p, 3, j] * DB[3, k]
                    )
        _assemble(Ke, fe, conn[e], slope, dofs, kmap[e], f, kdata)


@nb.njit(cache=True, error_model="numpy")
def _deformed_strain_matrices(xe, B, w, dN):
    """Fill B-bar matrices, weights and gradients (N_r, N_z, N/r) of one element at nodes `xe`."""
    g = 1 / np.sqrt(3.0)
    mean = np.zeros(8)
    total = 0.0
    for p in range(4):
        xi = -g if p == 0 or p == 3 else g
        eta = -g if p < 2 else g
        a = b = c = d = radius = 0.0
        for i in range(4):
            sx = -1.0 if i == 0 or i == 3 else 1.0
            sy = -1.0 if i < 2 else 1.0
            dN[p, i, 0] = 0.25 * sx * (1 + sy * eta)
            dN[p, i, 1] = 0.25 * sy * (1 + sx * xi)
            dN[p, i, 2] = 0.25 * (1 + sx * xi) * (1 + sy * eta)
            a += dN[p, i, 0] * xe[2 * i]
            b += dN[p, i, 0] * xe[2 * i + 1]
            c += dN[p, i, 1] * xe[2 * i]
            d += dN[p, i, 1] * xe[2 * i + 1]
            radius += dN[p, i, 2] * xe[2 * i]
        det = a * d - b * c
        w[p] = 2 * np.pi * radius * det
        for i in range(4):
            nr = (d * dN[p, i, 0] - b * dN[p, i, 1]) / det
            nz = (-c * dN[p, i, 0] + a * dN[p, i, 1]) / det
            dN[p, i, 0] = nr
            dN[p, i, 1] = nz
            dN[p, i, 2] /= radius
            B[p, 0, 2 * i] = nr
            B[p, 0, 2 * i + 1] = 0.0
            B[p, 1, 2 * i] = 0.0
            B[p, 1, 2 * i + 1] = nz
            B[p, 2, 2 * i] = dN[p, i, 2]
            B[p, 2, 2 * i + 1] = 0.0
            B[p, 3, 2 * i] = nz
            B[p, 3, 2 * i + 1] = nr
            mean[2 * i] += w[p] * (nr + dN[p, i, 2])
            mean[2 * i + 1] += w[p] * nz
        total += w[p]
    for p in range(4):
        for k in range(8):
            change = (mean[k] / total - B[p, 0, k] - B[p, 1, k] - B[p, 2, k]) / 3
            for m in range(3):
                B[p, m, k] += change


@nb.njit(cache=True, error_model="numpy")
def _element_pass_finite(
    u, u_old, X, conn, sig_old, al_old, G, bulk, strength, H, n, E, kmap, slope, sig, al, f, kdata
):
    """Like `_element_pass` for finite strains: midpoint strain and Hughes-Winget rotation."""
    f[:] = 0.0
    kdata[:] = 0.0
    dofs = np.empty(8, np.int64)
    x_mid = np.empty(8)
    x_new = np.empty(8)
    du = np.empty(8)
    D = np.empty((4, 4))
    DB = np.empty((4, 8))
    Ke = np.empty((8, 8))
    fe = np.empty(8)
    s = np.empty(4)
    nv = np.empty(4)
    B_mid = np.empty((4, 4, 8))
    B = np.empty((4, 4, 8))
    w_mid = np.empty(4)
    w = np.empty(4)
    dN_mid = np.empty((4, 4, 3))
    dN = np.empty((4, 4, 3))
    for e in range(conn.shape[0]):
        for i in range(4):
            dofs[2 * i] = 2 * conn[e, i]
            dofs[2 * i + 1] = 2 * conn[e, i] + 1
        for k in range(8):
            du[k] = u[dofs[k]] - u_old[dofs[k]]
            x_new[k] = X[dofs[k]] + u[dofs[k]]
            x_mid[k] = x_new[k] - 0.5 * du[k]
        _deformed_strain_matrices(x_mid, B_mid, w_mid, dN_mid)
        _deformed_strain_matrices(x_new, B, w, dN)
        Ke[:] = 0.0
        fe[:] = 0.0
        for p in range(4):
            e0 = e1 = e2 = e3 = spin = 0.0
            for k in range(8):
                e0 += B_mid[p, 0, k] * du[k]
                e1 += B_mid[p, 1, k] * du[k]
                e2 += B_mid[p, 2, k] * du[k]
                e3 += B_mid[p, 3, k] * du[k]
            for i in range(4):
                spin += 0.5 * (dN_mid[p, i, 1] * du[2 * i] - dN_mid[p, i, 0] * du[2 * i + 1])
            cs = (1 - spin * spin / 4) / (1 + spin * spin / 4)
            sn = spin / (1 + spin * spin / 4)
            rr, zz, tt, rz = sig_old[e, p, 0], sig_old[e, p, 1], sig_old[e, p, 2], sig_old[e, p, 3]
            rot_rr = cs * cs * rr + 2 * cs * sn * rz + sn * sn * zz
            rot_zz = sn * sn * rr - 2 * cs * sn * rz + cs * cs * zz
            rot_rz = (cs * cs - sn * sn) * rz + cs * sn * (zz - rr)
            tr = e0 + e1 + e2
            mean_old = (rot_rr + rot_zz + tt) / 3
            pressure = mean_old + bulk * tr
            s[0] = rot_rr - mean_old + 2 * G * (e0 - tr / 3)
            s[1] = rot_zz - mean_old + 2 * G * (e1 - tr / 3)
            s[2] = tt - mean_old + 2 * G * (e2 - tr / 3)
            s[3] = rot_rz + G * e3
            norm = np.sqrt(s[0] ** 2 + s[1] ** 2 + s[2] ** 2 + 2 * s[3] ** 2)
            q = np.sqrt(1.5) * norm
            a0 = al_old[e, p]
            sy, hard = _flow_stress(a0, strength, H, n, E)
            theta = 1.0
            theta_n = 0.0
            al[e, p] = a0
            if q > sy * (1 + 1e-10):
                dg = (q - sy) / (3 * G + hard)
                if n != 0.0:
                    for _ in range(30):
                        sy, hard = _flow_stress(a0 + dg, strength, H, n, E)
                        step = (q - 3 * G * dg - sy) / (3 * G + hard)
                        dg += step
                        if abs(step) < 1e-14:
                            break
                    sy, hard = _flow_stress(a0 + dg, strength, H, n, E)
                theta = 1 - 3 * G * dg / q
                theta_n = 3 * G / (3 * G + hard) - (1 - theta)
                al[e, p] = a0 + dg
                for m in range(4):
                    nv[m] = s[m] / norm
                    s[m] *= theta
            for m in range(3):
                s[m] += pressure
            for m in range(4):
                sig[e, p, m] = s[m]
            wp = w[p]
            for k in range(8):
                fe[k] += wp * (
                    B[p, 0, k] * s[0] + B[p, 1, k] * s[1] + B[p, 2, k] * s[2] + B[p, 3, k] * s[3]
                )
            g2 = 2 * G * theta
            for i in range(4):
                for j in range(4):
                    D[i, j] = 0.0
            for i in range(3):
                for j in range(3):
                    D[i, j] = bulk - g2 / 3
                D[i, i] += g2
            D[3, 3] = g2 / 2
            if theta_n != 0.0:
                for i in range(4):
                    for j in range(4):
                        D[i, j] -= 2 * G * theta_n * nv[i] * nv[j]
            for i in range(3):
                D[i, i] -= 2 * s[i]
            D[3, 3] -= 0.5 * (s[0] + s[1])
            for i in range(2):
                D[i, 3] -= s[3]
                D[3, i] -= s[3]
            for i in range(4):
                for k in range(8):
                    DB[i, k] = wp * (
                        D[i, 0] * B[p, 0, k]
                        + D[i, 1] * B[p, 1, k]
                        + D[i, 2] * B[p, 2, k]
                        + D[i, 3] * B[p, 3, k]
                    )
            for j in range(8):
                for k in range(j, 8):
                    Ke[j, k] += (
                        B[p, 0, j] * DB[0, k]
                        + B[p, 1, j] * DB[1, k]
                        + B[p, 2, j] * DB[2, k]
                        + B[p, 3, j] * DB[3, k]
                    )
            for i in range(4):
                for j in range(i, 4):
                    geo = wp * (
                        dN[p, i, 0] * (s[0] * dN[p, j, 0] + s[3] * dN[p, j, 1])
                        + dN[p, i, 1] * (s[3] * dN[p, j, 0] + s[1] * dN[p, j, 1])
                    )
                    Ke[2 * i, 2 * j] += geo + wp * s[2] * dN[p, i, 2] * dN[p, j, 2]
                    Ke[2 * i + 1, 2 * j + 1] += geo
        _assemble(Ke, fe, conn[e], slope, dofs, kmap[e], f, kdata)


class _Factor:
    """Sparse symmetric solver with a fixed pattern."""

    def __init__(self, indptr, indices):
        self.indptr, self.indices, self.n = indptr, indices, len(indptr) - 1
        self._solver = PyPardisoSolver(mtype=-2) if PyPardisoSolver else None
        self._analysed = False
        self._rows = np.repeat(np.arange(self.n), np.diff(indptr))
        self._diagonal = indptr[:-1]  # the first entry of each row of the upper triangle

    def solve(self, data, b):
        # Entries grow with the radius, and PARDISO compares pivots with the largest entry.
        scale = 1 / np.sqrt(np.abs(data[self._diagonal]))
        data = data * scale[self._rows] * scale[self.indices]
        return scale * self._solve(data, scale * b)

    def _solve(self, data, b):
        A = csr_matrix((data, self.indices, self.indptr), shape=(self.n, self.n))
        if self._solver is None:
            diagonal = csr_matrix((A.diagonal(), (range(self.n), range(self.n))))
            return splu(csc_matrix(A + A.T - diagonal)).solve(b)
        if not self._analysed:
            self._solver.set_phase(11)
            self._solver._call_pardiso(A, b)
            self._analysed = True
        self._solver.set_phase(23)
        try:
            return self._solver._call_pardiso(A, b)
        except PyPardisoError as error:
            raise RuntimeError(str(error)) from error

    def close(self):
        if self._solver is not None:
            self._solver.free_memory(everything=True)


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
            gap and normal at the deformed radius) or "flattening" (finite strains, the body has
            the profile and the rigid surface is flat).
    """

    def __init__(self, model: Model, spec: MeshSpec, kinematics: str = "small"):
        if kinematics not in ("small", "deformed-contact", "finite", "flattening"):
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
        self.coordinates = np.stack([r, z + shift], axis=1).ravel()
        self.ndof, self.conn, self.elements = 2 * nr * nz, conn, len(conn)
        self.B = np.empty((self.elements, 4, 4, 8))
        self.w = np.empty((self.elements, 4))
        _strain_matrices(r, z, conn, self.B, self.w)

        dofs = np.stack([2 * conn, 2 * conn + 1], axis=2).reshape(-1, 8)
        rows, cols = np.repeat(dofs, 8, axis=1), np.tile(dofs, (1, 8))
        keys = np.minimum(rows, cols).astype(np.int64) * self.ndof + np.maximum(rows, cols)
        unique, inverse = np.unique(keys.ravel(), return_inverse=True)
        self.kmap = inverse.reshape(self.elements, 8, 8).astype(np.int64)
        self.rows, self.cols = unique // self.ndof, (unique % self.ndof).astype(np.int32)
        self.indptr = np.searchsorted(self.rows, np.arange(self.ndof + 1)).astype(np.int32)
        self.diagonal = np.flatnonzero(self.rows == self.cols)  # one per row, in order
        self.kdata = np.empty(len(unique))
        self.factor = _Factor(self.indptr, self.cols)

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
        if self.kinematics == "flattening":
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
        if self.kinematics in ("finite", "flattening"):
            _element_pass_finite(u, state.u, self.coordinates, self.conn, *old, *material)
        else:
            _element_pass(u, self.B, self.w, self.conn, *old, *material)

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
        if self.kinematics != "small":
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

    def unload(self, state: State, force_step: float = _UNLOADING_FORCE_STEP) -> Curve:
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


def loading_work(indentation, force, first_exponent=1.5) -> np.ndarray:
    """Return ∫F dδ (J) up to each point, with F a power of δ between two points.

    Args:
        indentation: depths (m), increasing, the first above 0.
        force: forces (N).
        first_exponent: F ∝ δ^exponent below the first point.
    """
    d, f = np.asarray(indentation), np.asarray(force)
    n = np.log(f[1:] / f[:-1]) / np.log(d[1:] / d[:-1])
    parts = (f[1:] * d[1:] - f[:-1] * d[:-1]) / (n + 1)
    return np.concatenate([[0], np.cumsum(parts)]) + f[0] * d[0] / (first_exponent + 1)


def unloading_work(indentation, force) -> float:
    """Return ∫F dδ (J) over an unloading curve (m, N) by monotone cubic interpolation."""
    d, f = np.asarray(indentation)[::-1], np.asarray(force)[::-1]
    keep = np.concatenate([[True], np.diff(d) > 0])
    return float(PchipInterpolator(d[keep], f[keep]).integrate(d[0], d[-1]))


def smooth_mesh(
    model: Model, omega_max: float, elements: float = 60, refinement: int = 1
) -> MeshSpec:
    """Return a mesh with about `elements` over the contact radius at ω = `omega_max`.

    Args:
        model: material and profile.
        omega_max: largest indentation over δ_c.
        elements: elements over the expected contact radius before refinement.
        refinement: divisor of all element sizes.
    """
    # a² / (Rδ) grows from 1 (elastic) to about 2 (fully plastic)
    growth = min(1.0 + 0.115 * np.log(max(omega_max, 1.0)), 1.50)
    if model.yield_strength is None:
        growth = 1.0
    a = growth * np.sqrt(model.radius * omega_max * model.critical_indentation)
    k = 1 / refinement
    return MeshSpec(a / elements * k, 1.08 * a, 0.5 * a, 3 * a, 100 * a, 1.10**k, 1.06**k, 1.25**k)


def wave_mesh(model: Model, omega_max: float, per_wave: float, refinement: int = 1) -> MeshSpec:
    """Return a mesh with `per_wave` elements per wavelength over the contact at `omega_max`."""
    depth = omega_max * model.critical_indentation
    a = 1.15 * np.sqrt(model.radius * depth)
    k = 1 / refinement
    return MeshSpec(
        model.wavelength / per_wave * k,
        1.1 * a,
        0.3 * model.wavelength,
        3 * a,
        100 * a,
        1.10**k,
        1.06**k,
        1.25**k,
    )


def load_steps(start: float, low: float, omegas, coarse: float, fine: float):
    """Return geometric steps of ω from `start`: `coarse` below `low`, `fine` above.

    Args:
        start: first ω.
        low: ω where the fine steps begin.
        omegas: values of ω that must be met.
        coarse: relative step below `low`.
        fine: relative step above `low`.
    """
    steps = [start]
    for stop in sorted({w for w in (low, *omegas) if w > start * 1.0001}):
        size = fine if stop > low * 1.0001 else coarse
        count = max(1, int(np.ceil(np.log(stop / steps[-1]) / np.log1p(size) - 1e-9)))
        steps += list(steps[-1] * (stop / steps[-1]) ** (np.arange(1, count + 1) / count))
        steps[-1] = stop
    return np.array(steps)


def run_range(
    model: Model,
    spec: MeshSpec,
    omegas,
    low: float,
    start: float,
    coarse: float = 0.07,
    fine: float = 0.035,
    force_step: float = _UNLOADING_FORCE_STEP,
    report=None,
    kinematics: str = "small",
) -> dict:
    """Load on one mesh, unload from each ω in `omegas`, and return plain numbers (SI units)."""
    began = time.perf_counter()
    body = Indentation(model, spec, kinematics)
    steps = load_steps(start, low, omegas, coarse, fine)
    stops = {int(np.argmin(abs(steps - w))): w for w in omegas}
    iterations: list[int] = []
    curve, kept = body.load(
        steps * model.critical_indentation,
        stops,
        lambda s: (iterations.append(s.iterations), report and report(s)),
    )
    unloading = []
    for k, omega in stops.items():
        try:
            path = body.unload(kept[k], force_step)
        except RuntimeError as error:
            print(f"unloading from omega {omega:g} left out: {error}", flush=True)
            continue
        unloading.append(
            {
                "omega": omega,
                "indentation_m": path.indentation,
                "force_N": path.force,
                "contact_area_m2": path.area,
            }
        )
    largest = float(np.sqrt(max(curve.area) / np.pi))
    body.close()
    return {
        "mesh": {
            "element_size_m": spec.element_size,
            "elements": body.elements,
            "elements_over_radius": round(largest / spec.element_size, 1),
            "uniform_radius_m": spec.uniform_radius,
            "uniform_depth_m": spec.uniform_depth,
            "domain_m": spec.domain,
            "domain_over_radius": round(spec.domain / largest, 1),
            "omega_low": low,
            "omega_high": float(max(omegas)),
            "fine_step": fine,
            "coarse_step": coarse,
            "newton_iterations": int(sum(iterations)),
            "run_time_s": round(time.perf_counter() - began, 1),
        },
        "omega": steps.tolist(),
        "loading": {
            "indentation_m": curve.indentation,
            "force_N": curve.force,
            "contact_area_m2": curve.area,
            "contact_area_inner_m2": curve.area_inner,
            "contact_area_outer_m2": curve.area_outer,
        },
        "unloading": unloading,
    }


def versions() -> dict[str, str]:
    """Return the versions of the packages that were used."""
    import platform
    from importlib.metadata import PackageNotFoundError, version

    found = {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "numba": nb.__version__,
    }
    for name in ("pypardiso", "mkl"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "absent"
    return found


def main() -> None:
    """Solve one model on one mesh and print a summary."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--youngs-modulus", type=float, default=210e9, help="Pa")
    parser.add_argument("--poissons-ratio", type=float, default=0.3)
    parser.add_argument("--yield-strength", type=float, help="Pa; left out: elastic")
    parser.add_argument("--hardening-modulus", type=float, default=0.0, help="Pa")
    parser.add_argument("--hardening-exponent", type=float, default=0.0)
    parser.add_argument("--radius", type=float, default=500e-6, help="m")
    parser.add_argument("--wave-amplitude", type=float, default=0.0, help="m")
    parser.add_argument("--wavelength", type=float, default=0.0, help="m")
    parser.add_argument("--omega", type=float, nargs="+", default=[2.0, 4.0, 8.0])
    parser.add_argument("--start", type=float, default=0.8, help="first ω")
    parser.add_argument("--elements", type=int, default=60, help="over the contact radius")
    parser.add_argument("--step", type=float, default=0.035, help="relative step of ω")
    parser.add_argument(
        "--kinematics",
        default="small",
        choices=("small", "deformed-contact", "finite", "flattening"),
    )
    parser.add_argument("--verbose", action="store_true")
    parser.add_argument("--output", help="JSON file for the curves")
    a = parser.parse_args()
    model = Model(
        a.youngs_modulus,
        a.poissons_ratio,
        a.yield_strength,
        a.hardening_modulus,
        a.hardening_exponent,
        a.radius,
        a.wave_amplitude,
        a.wavelength,
    )
    spec = smooth_mesh(model, max(a.omega), a.elements)

    def show(s):
        print(
            f"{s.indentation / model.critical_indentation:9.4f} {s.force:12.6g} "
            f"{s.active.sum():5d} {s.iterations:3d}",
            flush=True,
        )

    result = run_range(
        model,
        spec,
        a.omega,
        a.omega[0],
        a.start,
        fine=a.step,
        coarse=a.step,
        report=show if a.verbose else None,
        kinematics=a.kinematics,
    )
    print(result["mesh"])
    work = loading_work(result["loading"]["indentation_m"], result["loading"]["force_N"])
    E_star, R = model.contact_modulus, model.radius
    for path in result["unloading"]:
        k = int(np.argmin(abs(np.array(result["omega"]) - path["omega"])))
        d, f = path["indentation_m"][0], path["force_N"][0]
        cor = np.sqrt(unloading_work(path["indentation_m"], path["force_N"]) / work[k])
        hertz = 4 / 3 * E_star * np.sqrt(R) * d**1.5
        area = result["loading"]["contact_area_m2"][k]
        print(
            f"omega {path['omega']:7.2f}  F {f:.6g} N (Hertz {f / hertz:.5f})  "
            f"A/(pi R d) {area / (np.pi * R * d):.4f}  COR {cor:.5f}  "
            f"unloading steps {len(path['force_N'])}"
        )
    if a.output:
        with open(a.output, "w") as file:
            json.dump(result, file)


if __name__ == "__main__":
    main()
