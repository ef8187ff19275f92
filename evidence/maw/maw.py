"""Oblique impact of an elastic sphere by annuli of traction, as in Maw, Barber and Fawcett (1976).

Wear 38 (1976) 101-114: the contact circle is divided into annuli of constant traction. In each time
step an annulus either sticks (the surface there follows the bodies) or slides (its traction is the
friction coefficient times Hertz's pressure). This program shares no code with the row of springs:
its unknowns are tractions on the surface, and its influence coefficients are those of a uniformly
loaded circle (Johnson, Contact Mechanics, eq. 3.29, with elliptic integrals). As in the paper, the
tangential displacement is averaged around the circle.

Lengths are in units of the largest indentation (R = 1 too), E* = 1 and m* = 1. With the ratio
kappa = G*/E* = 2 (1 - nu)/(2 - nu) of equal materials,

    psi_1 = kappa U/(mu V_n) before the impact, psi_2 = kappa U'/(mu V_n) after it,

where U is the tangential velocity of the contact point. The paper's chi is 7 kappa/4. Writes
maw.csv, with psi_2 on three grids and their extrapolation. Takes about two minutes.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipe, ellipk

from evidence.shared import write_table

NU = 0.3
KAPPA = 2 * (1 - NU) / (2 - NU)
PSI = (0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0)
RINGS = (30, 60, 120)  # annuli in the largest contact; the time steps are twelve times as many
VELOCITY = np.sqrt(16 / 15)  # impact velocity with the largest indentation 1
INERTIA = 3.5


def circle(c: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Displacement at `r` by unit traction on the circle of radius `c`, for a modulus of 1."""
    inside = r < c
    m = np.where(inside, r / np.maximum(c, 1e-300), c / r) ** 2
    within = c * ellipe(m)
    outside = r * (ellipe(m) - (1 - m) * ellipk(m))
    return 4 / np.pi * np.where(inside, within, outside)


def influence(edges: np.ndarray) -> np.ndarray:
    """Displacement in the middle of every annulus by unit traction on every annulus."""
    r = 0.5 * (edges[1:] + edges[:-1])
    return circle(edges[None, 1:], r[:, None]) - circle(edges[None, :-1], r[:, None])


def indentation(times: np.ndarray) -> np.ndarray:
    """Hertz's indentation at shares `times` of the contact time, and the contact time last."""

    def end(t: float, y: np.ndarray) -> float:
        return y[0] if t > 0.1 else 1.0

    end.terminal = True
    found = solve_ivp(
        lambda _, y: [y[1], -4 / 3 * max(y[0], 0.0) ** 1.5],
        (0, 10),
        [0.0, VELOCITY],
        method="DOP853",
        rtol=1e-11,
        atol=1e-13,
        events=end,
        dense_output=True,
    )
    last = found.t_events[0][0]
    return np.append(np.maximum(found.sol(times * last)[0], 0.0), last)


def pressure(edges: np.ndarray, a: float) -> np.ndarray:
    """Hertz's pressure for the contact radius `a` (R = E* = 1), averaged over every annulus."""
    height = np.maximum(a**2 - edges**2, 0.0) ** 1.5
    return 4 / (3 * np.pi) * (height[:-1] - height[1:]) / np.diff(edges**2)


def step(
    K: np.ndarray, before: np.ndarray, motion: float, limit: np.ndarray, touching: np.ndarray
) -> np.ndarray:
    """The tractions after the bodies have moved by `motion`; `before` are the displacements."""
    q = np.zeros(limit.size)
    sign = np.zeros(limit.size)  # of annuli that slide
    for _ in range(100):
        stick = touching & (sign == 0)
        q[:] = sign * limit
        right = before[stick] + motion - K[stick] @ q
        q[stick] = np.linalg.solve(K[np.ix_(stick, stick)], right)
        over = stick & (np.abs(q) > limit * (1 + 1e-12))
        slip = motion - (K @ q - before)
        back = touching & (sign != 0) & (slip * sign < 0)
        if not over.any() and not back.any():
            return q
        sign[over] = np.sign(q[over])
        sign[back] = 0.0
    return np.clip(q, -limit, limit)


def impact(psi: float, rings: int) -> float:
    """psi_2 of an impact at psi_1 = `psi`; the friction coefficient is 1."""
    edges = np.linspace(0, 1, rings + 1)
    K, area = influence(edges) / KAPPA, np.pi * np.diff(edges**2)
    steps = 12 * rings
    *depths, duration = indentation(np.linspace(0, 1, steps + 1))
    dt = duration / steps
    speed = psi * VELOCITY / KAPPA
    w = np.zeros(rings)
    for depth in depths[1:-1]:
        a = np.sqrt(depth)
        q = step(K, w, speed * dt, pressure(edges, a), edges[:-1] < a)
        w = K @ q
        speed -= INERTIA * float(q @ area) * dt
    return float(KAPPA * speed / VELOCITY)


def main() -> None:
    """Write maw.csv."""
    rows = []
    for psi in PSI:
        found = [impact(psi, rings) for rings in RINGS]
        best = 2 * found[-1] - found[-2]  # the error is of first order in the annuli
        rows.append(
            {
                "psi_1": psi,
                **{f"psi_2_{n}_rings": f"{v:.6f}" for n, v in zip(RINGS, found, strict=True)},
                "psi_2": f"{best:.5f}",
                "error": f"{abs(best - found[-1]):.5f}",
            }
        )
        print(rows[-1])
    write_table("maw/maw.csv", rows)


if __name__ == "__main__":
    main()
