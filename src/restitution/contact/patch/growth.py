"""A bound that grows on the nodes of a patch, from elastic states of this patch.

As in `plasticity.cavity`, the bound at a node is a function of its elastic pressure at twice the
indentation, where the nominal pressure is √2 times as large (Hertz).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.models import Plasticity
from restitution.contact.state import Array
from restitution.errors import DomainError

_RISE = math.sqrt(2)
_ROUGH = 1e-4  # tolerance of the elastic states
_BEYOND = 2.0  # exponent of the nominal pressure against the depth beyond complete contact
_NOMINAL = 24  # values in the table of mean bounds


@dataclass(frozen=True, eq=False)
class PatchBounds:
    """Bounds of the nodes of an elastic, periodic `contact` if it yields by `plasticity`.

    At each `depth` (m) the elastic patch has the `nominal` pressure (Pa) and its nodes the
    `pressure` (Pa). The last one is complete contact, from where the pressure grows uniformly.
    """

    contact: Contact
    plasticity: Plasticity
    depth: Array
    nominal: Array
    pressure: tuple[Array, ...]

    @classmethod
    def of(cls, contact: Contact, plasticity: Plasticity, depths: Sequence[float]) -> PatchBounds:
        """Solve `contact` at `depths` (m), as far as it is not complete."""
        nothing = np.zeros(contact.grid.nodes)
        depth, nominal, pressure = [0.0], [0.0], [nothing]
        for d in depths:
            try:
                state = solve(contact, d, residual=_ROUGH)
            except DomainError:
                break
            depth.append(d)
            nominal.append(state.nominal_pressure)
            pressure.append(np.asarray(state.box_pressure))
        waves = _pressure_of_waves(contact)
        complete = max(-float(waves.min()), (1 + _ROUGH) * nominal[-1])
        depth.append(float(contact.gap.mean()))
        nominal.append(complete)
        pressure.append(np.maximum(waves + complete, 0.0))
        return cls(contact, plasticity, np.array(depth), np.array(nominal), tuple(pressure))

    def elastic(self, depth: float) -> float:
        """Nominal pressure (Pa) of the elastic patch at a `depth` (m)."""
        beyond = max(depth / float(self.depth[-1]), 1.0) ** _BEYOND
        return float(np.interp(depth, self.depth, self._roots) ** 3 * beyond)

    def at(self, depth: float, nominal: float) -> Array:
        """Bound (Pa) of each node at a `depth` (m).

        `nominal` (Pa) is the nominal pressure of elastic bodies at the same indentation.
        """
        p, known = _RISE * nominal, self.nominal
        k = min(int(np.searchsorted(known, p, side="right")), known.size - 1)
        share = min((p - known[k - 1]) / (known[k] - known[k - 1]), 1.0)
        pressure = (1 - share) * self.pressure[k - 1] + share * self.pressure[k]
        pressure += max(p - float(known[-1]), 0.0)
        return self.plasticity.bound_of_waves(self.contact, depth, pressure / _RISE, p)

    def of_mean(self) -> tuple[Array, Array]:
        """Bounds (Pa) of smooth bodies, and the mean bound of the patch divided by each of them."""
        measure, bound = self.plasticity.smooth_bounds(self.contact.pair, _NOMINAL)
        mean = np.array([self.at(self._depth_at(m), m).mean() for m in measure.tolist()])
        return bound, mean / bound

    def _depth_at(self, nominal: float) -> float:
        beyond = max(nominal / float(self.nominal[-1]), 1.0) ** (1 / _BEYOND)
        return float(np.interp(np.cbrt(nominal), self._roots, self.depth) * beyond)

    @cached_property
    def _roots(self) -> Array:
        return np.cbrt(self.nominal)


def _pressure_of_waves(contact: Contact) -> Array:
    """Pressure (Pa) with zero mean that flattens the surface."""
    from scipy.fft import irfft2, rfft2

    (nx, ny), (hx, hy) = contact.grid.nodes, contact.grid.spacing
    q = 2 * np.pi * np.hypot(np.fft.fftfreq(nx, hx)[:, None], np.fft.rfftfreq(ny, hy)[None, :])
    modes = -0.5 * contact.pair.contact_modulus * q * rfft2(np.asarray(contact.gap))
    return np.asarray(irfft2(modes, s=(nx, ny)))
