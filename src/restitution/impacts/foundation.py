"""A row of springs (a foundation) that replaces a contact whose force curves are stored.

A spring at the distance x from the middle touches at the indentation g(x), where g is the inverse
of the contact radius a(δ) = F′(δ)/2E*. Its normal load per length is 2E* (δ − g), its tangential
load 2G* u, at most µ times the normal load. For a sphere this is exact (Popov and Heß 2015, Method
of Dimensionality Reduction, chapters 3 and 5); else it is the approximation of Jäger (1995, Arch.
Appl. Mech. 65, 478–487) and Ciavarella (1998, Int. J. Solids Struct. 35, 2349–2378). After yield
the loads follow from the unloading curve that starts at the depth, which is not in this literature.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.impacts.stored_force import StoredForce

Array = NDArray[np.float64]

_SPRINGS = 400  # number of springs on each half of the line
_DEPTHS = 200  # number of loading depths at which the loads of the springs are tabulated
# A contact counts as elastic if the residual indentation is less than this fraction of the largest
# indentation.
_ELASTIC = 1e-3
_POINTS = 400  # number of points of an unloading curve at which its slope is computed


@dataclass(frozen=True, eq=False)
class Foundation:
    """The springs that replace a contact, for loading up to `depths[-1]` (m).

    `radius` (m, shape (n,)) holds the distances of the springs from the middle of the line, `width`
    (m) their spacing, and `loads` (N/m, shape (depths, n)) their normal loads per length at each
    depth of loading; the two springs at one distance count as one. `moduli` are E* and G* (Pa).
    """

    radius: Array
    width: float
    depths: Array
    loads: Array
    moduli: tuple[float, float]

    @classmethod
    def of(cls, law: StoredForce, deepest: float) -> Foundation:
        """The foundation of the force `law`, loaded up to `deepest` (m)."""
        E, G = law.pair.contact_modulus, law.pair.tangential_modulus
        depths = np.linspace(0.0, deepest, _DEPTHS + 1)[1:]
        if has_yielded(law, deepest):
            curves = [_touching(law, float(depth), E) for depth in depths]
        else:
            # The loading and unloading curves of an elastic contact are the same, so one curve
            # holds for all depths.
            curves = [_touching(law, deepest, E)] * _DEPTHS
        width = max(radii[-1] for _, radii in curves) / _SPRINGS
        x = (np.arange(_SPRINGS) + 0.5) * width
        loads = np.zeros((_DEPTHS, _SPRINGS))
        for row, depth, (reached, radii) in zip(loads, depths, curves, strict=True):
            touch = np.interp(x, radii, reached)
            row[:] = np.where(x < radii[-1], 2 * E * np.maximum(depth - touch, 0.0), 0.0)
        return cls(x, width, depths, loads, (E, G))

    def load(self, indentation: float, deepest: float) -> Array:
        """Normal load (N) of every spring at `indentation` (m), after loading to `deepest` (m)."""
        share = np.clip(deepest / self.depths[0] - 1, 0.0, len(self.depths) - 1.0)
        k = min(int(share), len(self.depths) - 2)
        at_deepest = self.loads[k] + (share - k) * (self.loads[k + 1] - self.loads[k])
        if deepest < self.depths[0]:
            at_deepest = at_deepest * deepest / self.depths[0]
        lifted = 2 * self.moduli[0] * (deepest - indentation)
        load: Array = np.maximum(at_deepest - lifted, 0.0) * self.width
        return load

    def move(
        self, u: Array, motion: Array | float, limit: Array, factor: Array | float = 1.0
    ) -> tuple[Array, Array, Array]:
        """Move the bodies tangentially by `motion` (m).

        `u` (m) holds the displacements of the springs, `limit` (N) their friction limits, and
        `factor` scales the tangential modulus; `motion` and `factor` may have a value for each row
        of `u`. Returns the new displacements (m), the tangential force (N), and the work of
        friction (J).
        """
        stiffness = 2 * self.moduli[1] * self.width * np.asarray(factor)
        largest = limit / stiffness[..., None]
        free = u + np.asarray(motion)[..., None]
        held = np.clip(free, -largest, largest)
        work = 0.5 * stiffness * np.einsum("...i,...i->...", u + held, free - held)
        return held, stiffness * held.sum(axis=-1), work


def has_yielded(law: StoredForce, deepest: float) -> bool:
    """Whether unloading from the depth `deepest` (m) leaves a residual indentation."""
    return law.separation(deepest) > _ELASTIC * deepest


def _touching(law: StoredForce, depth: float, contact_modulus: float) -> tuple[Array, Array]:
    """Indentations (m) on the unloading curve from `depth` (m), and their contact radii (m).

    Radii never decrease with the indentation, so that every spring touches once; they are scaled so
    that the loads add up to the force.
    """
    end, force = law.separation(depth), law.loading(depth)
    shape, _ = law.shape(depth)
    s = np.linspace(0.0, 1.0, _POINTS + 1)
    F = force * np.asarray(shape(s))
    slope = np.maximum.accumulate(np.maximum(np.diff(F), 0.0)) / ((depth - end) / _POINTS)
    slope *= force / (slope.sum() * (depth - end) / _POINTS)
    middle = end + (s[:-1] + 0.5 / _POINTS) * (depth - end)
    return np.append(end, middle), np.append(0.0, slope / (2 * contact_modulus))
