"""Four-node axisymmetric elements with B-bar: internal forces and stiffness, compiled."""

from __future__ import annotations

import numba as nb
import numpy as np
from material import radial_return, tangent


@nb.njit(cache=True, error_model="numpy")
def strain_matrices(r, z, conn, B, w):
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
def element_pass(
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
            dg, theta, theta_n = radial_return(s, nv, al_old[e, p], G, strength, H, n, E)
            al[e, p] = al_old[e, p] + dg
            for m in range(4):
                ep[e, p, m] = ep_old[e, p, m]
            if dg > 0.0:
                c = np.sqrt(1.5) * dg
                for m in range(3):
                    ep[e, p, m] += c * nv[m]
                ep[e, p, 3] += 2 * c * nv[3]
            pressure = bulk * tr
            wp = w[e, p]
            for k in range(8):
                fe[k] += wp * (
                    B[e, p, 0, k] * (s[0] + pressure)
                    + B[e, p, 1, k] * (s[1] + pressure)
                    + B[e, p, 2, k] * (s[2] + pressure)
                    + B[e, p, 3, k] * s[3]
                )
            tangent(D, nv, G, bulk, theta, theta_n)
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
def element_pass_finite(
    u, u_old, X, conn, sig_old, al_old, G, bulk, strength, H, n, E, kmap, slope, sig, al, f, kdata
):
    """Like `element_pass` for finite strains: midpoint strain and Hughes-Winget rotation."""
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
            dg, theta, theta_n = radial_return(s, nv, al_old[e, p], G, strength, H, n, E)
            al[e, p] = al_old[e, p] + dg
            for m in range(3):
                s[m] += pressure
            for m in range(4):
                sig[e, p, m] = s[m]
            wp = w[p]
            for k in range(8):
                fe[k] += wp * (
                    B[p, 0, k] * s[0] + B[p, 1, k] * s[1] + B[p, 2, k] * s[2] + B[p, 3, k] * s[3]
                )
            tangent(D, nv, G, bulk, theta, theta_n)
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
