"""J2 flow with isotropic hardening: radial return and its consistent tangent.

Stresses and strains have the components rr, zz, tt, rz; shear strains are engineering ones.
"""

from __future__ import annotations

import numba as nb
import numpy as np


@nb.njit(cache=True, error_model="numpy")
def flow_stress(alpha, strength, H, n, E):
    if n == 0.0:
        return strength + H * alpha, H
    base = 1 + E * alpha / strength
    return strength * base**n, n * E * base ** (n - 1)


@nb.njit(cache=True, error_model="numpy")
def radial_return(s, normal, alpha, G, strength, H, n, E):
    """Return the trial deviator `s` to the yield surface (Simo and Taylor 1985), in place.

    Args:
        s: deviatoric trial stress, Pa; the stress after return.
        normal: its direction s/|s|, which is written where the point flows.
        alpha: equivalent plastic strain before.
        G: shear modulus, Pa.
        strength: initial yield strength, Pa.
        H: hardening modulus, Pa.
        n: hardening exponent.
        E: Young's modulus, Pa.

    Returns:
        The increment of equivalent plastic strain, and the factors θ and θ_n of `tangent`.
    """
    norm = np.sqrt(s[0] ** 2 + s[1] ** 2 + s[2] ** 2 + 2 * s[3] ** 2)
    q = np.sqrt(1.5) * norm
    sy, hard = flow_stress(alpha, strength, H, n, E)
    if q <= sy * (1 + 1e-10):
        return 0.0, 1.0, 0.0
    dg = (q - sy) / (3 * G + hard)
    if n != 0.0:
        for _ in range(30):
            sy, hard = flow_stress(alpha + dg, strength, H, n, E)
            step = (q - 3 * G * dg - sy) / (3 * G + hard)
            dg += step
            if abs(step) < 1e-14:
                break
        sy, hard = flow_stress(alpha + dg, strength, H, n, E)
    theta = 1 - 3 * G * dg / q
    for m in range(4):
        normal[m] = s[m] / norm
        s[m] *= theta
    return dg, theta, 3 * G / (3 * G + hard) - (1 - theta)


@nb.njit(cache=True, error_model="numpy")
def tangent(D, normal, G, bulk, theta, theta_n):
    """Write the consistent tangent of a point after `radial_return` into `D` (4 × 4), Pa."""
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
                D[i, j] -= 2 * G * theta_n * normal[i] * normal[j]
