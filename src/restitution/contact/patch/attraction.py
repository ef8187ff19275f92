"""Load and unload periodic patches that attract each other: their traction against the gap."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import NDArray

from restitution.contact.cohesive.bounded_law import law_of
from restitution.contact.cohesive.equilibrium import CohesiveState
from restitution.contact.cohesive.loading import load_cohesive
from restitution.contact.cohesive.steps import follow
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import RESIDUAL
from restitution.contact.patch.blocks import Shape, block_means
from restitution.contact.patch.stored import bodies_in_words, is_kept, kept
from restitution.contact.state import Array
from restitution.errors import DomainError
from restitution.numerics.convolution.cache import OperatorCache
from restitution.numerics.tabulated import Tabulated

# A patch is loaded up to this fraction of E*, or of the yield pressure if that is smaller, or until
# this fraction of it is in contact under a pressure of _BEYOND times w/z₀.
_HIGHEST, _OF_HARDNESS, _CLOSED, _BEYOND = 0.1, 0.97, 0.95, 3.0
_ACCURACY = 4e-5  # of the steps: finer than for a force, because the table is interpolated
_CELLS = 4096  # of the table
_RIGID = 100  # points of the pressure of rigid bodies
_FAR = 25.0  # gap at the end of the table beyond the highest asperity, in units of z₀


@dataclass(frozen=True, eq=False)
class AttractionCurve:
    """The loading of a patch; arrays against decreasing gap.

    `gap` (m) is the distance of the mean planes before deformation, `pressure` (Pa) the nominal
    pressure (tension is negative), `work` that of loading (J/m², 0 at infinity), `lost` the work
    per area that yielding and jumps have dissipated (J/m²), and `jumped` that of jumps alone.
    `blocks` has the mean pressure (Pa) of each block of the patch, with one row for each gap.
    """

    contact: Contact
    gap: Array
    pressure: Array
    work: Array
    lost: Array
    jumped: Array
    blocks: Array

    @classmethod
    def of(cls, contact: Contact, shape: Shape) -> AttractionCurve:
        """Load `contact`, a periodic contact with an attraction of finite range.

        `shape` is the number of blocks along each axis.
        """
        models = _models(contact, shape)
        return cls(contact, **kept(contact.surface, models, lambda: _columns(contact, shape)))

    @staticmethod
    def is_known(contact: Contact, shape: Shape) -> bool:
        """Whether `of` need not solve `contact`."""
        return is_kept(contact.surface, _models(contact, shape))

    def at(self, gap: Array) -> tuple[Array, Array, Array]:
        """Pressure, `lost` and `jumped` at each `gap` (m); rigid bodies beyond the first state."""
        from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

        inside = np.clip(gap, self.gap[-1], self.gap[0])
        # The energies are more accurate than an integral of the pressures between the states.
        work = CubicHermiteSpline(self.gap[::-1], self.work[::-1], -self.pressure[::-1])
        p = -work.derivative()(inside)
        lost, jumped = (
            PchipInterpolator(self.gap[::-1], of[::-1])(inside) for of in (self.lost, self.jumped)
        )
        far = gap > self.gap[0]
        if far.any():
            points = np.geomspace(self.gap[0], float(gap.max()), _RIGID)
            p[far] = PchipInterpolator(points, self._rigid(points))(gap[far])
        return p, lost, jumped

    def _rigid(self, gap: Array) -> Array:
        """Nominal pressure (Pa) of rigid bodies at each `gap` (m)."""
        law, local = law_of(self.contact), self.contact.gap - self.contact.gap.mean()
        return np.array([-float(law.traction(local + g).mean()) for g in gap.tolist()])


def _models(contact: Contact, shape: Shape) -> object:
    return bodies_in_words(contact.pair), contact.plasticity, contact.adhesion, shape


@dataclass(frozen=True, eq=False)
class _Loading:
    """States of a loading: rows of the first five columns, and pressures of all nodes."""

    rows: Array
    pressures: NDArray[np.float32]

    @property
    def nbytes(self) -> int:
        return self.rows.nbytes + self.pressures.nbytes

    @classmethod
    def of(cls, contact: Contact) -> _Loading:
        known = _recent.get(contact)
        if known is not None:
            return cast(_Loading, known)
        area, z0 = math.prod(contact.grid.size), law_of(contact).equilibrium_separation
        touch = float(contact.gap.mean()) + z0
        rows, pressures = [], []
        for state in _loading(contact):
            lost = state.plastic_work + state.adhesive_loss
            work = state.potential_energy + lost
            energies = (state.force, work, lost, state.adhesive_loss)
            rows.append((touch - state.indentation, *(value / area for value in energies)))
            pressures.append(state.box_pressure.astype(np.float32))
        loading = cls(np.array(rows), np.array(pressures))
        _recent.put(contact, loading)
        return loading


# Grids with other cells, of a refined run and of its companions, divide the same patches into other
# blocks.
_recent = OperatorCache(max_bytes=2**27, max_items=16)


def _columns(contact: Contact, shape: Shape) -> dict[str, Array]:
    loading = _Loading.of(contact)
    names = ("gap", "pressure", "work", "lost", "jumped")
    columns = dict(zip(names, loading.rows.T, strict=True))
    blocks = [block_means(pressure.astype(float), shape) for pressure in loading.pressures]
    return columns | {"blocks": np.array(blocks)}


def _loading(contact: Contact) -> Iterator[CohesiveState]:
    top = _HIGHEST * contact.pair.contact_modulus
    top = min(top, _OF_HARDNESS * contact.hardness)
    law = law_of(contact)
    beyond = _BEYOND * law.work_of_adhesion / law.equilibrium_separation
    begin = load_cohesive(contact, -np.inf, start=None, residual=RESIDUAL)
    yield begin
    try:
        for state in follow(begin, np.inf, residual=RESIDUAL, accuracy=_ACCURACY):
            yield state
            closed = state.relative_area > _CLOSED and state.nominal_pressure > beyond
            if closed or state.nominal_pressure > top:
                return
    except DomainError:  # the largest pressure of elastic bodies
        return


@dataclass(frozen=True, eq=False)
class AttractionTable:
    """The mean of several patches at equal gaps, as a function of the gap.

    Attributes:
        pressure: Nominal pressure (Pa) during loading; tension is negative.
        lost: Work per area dissipated by yielding and by jumps so far (J/m²).
        jumped: That by jumps (J/m²).
    """

    pressure: Tabulated
    lost: Array
    jumped: Array

    @classmethod
    def of(cls, curves: Sequence[AttractionCurve]) -> AttractionTable:
        """The mean of `curves`, down to the largest of their smallest gaps."""
        first = max(c.gap[-1] for c in curves)
        z0 = law_of(curves[0].contact).equilibrium_separation
        last = max(c.gap[0] for c in curves) + _FAR * z0
        # Denser where the pressure varies fast; the uniform table interpolates this one.
        gap = np.linspace(first, last, _CELLS + 1)
        p, lost, jumped = np.mean([c.at(gap) for c in curves], axis=0)
        return cls(Tabulated(first, (last - first) / _CELLS, p), lost, jumped)

    @property
    def _rest(self) -> float:
        """Integral of the pressure beyond the table."""
        return 0.5 * float(self.pressure.values[-1]) * self.pressure.last

    def potential(self, gap: Array) -> tuple[Array, Array, Array]:
        """Energy (J/m²), traction (Pa) and its derivative (Pa/m) at each `gap` (m).

        Beyond the table the traction falls with the third power of the gap.
        """
        end, p_end = self.pressure.last, self.pressure.values[-1]
        ratio = end / np.maximum(gap, end)
        energy, p = self._rest * ratio**2, p_end * ratio**3
        slope = -3 * p * ratio / end
        near = gap <= end
        integral, p[near], slope[near] = self.pressure(gap[near])
        energy[near] = self.pressure.whole - integral + self._rest
        return energy, -p, -slope

    def drawn(self, count: int) -> Array:
        """`count` gaps (m) that show the attraction, and as much repulsion."""
        gap, tension = self.largest_tension
        least = float(self.gap_at(np.asarray(tension)))
        return np.asarray(np.linspace(least, gap + 4 * (gap - least), count))

    def at(self, gap: Array) -> Array:
        """Pressure (Pa) at each `gap` (m)."""
        return -self.potential(gap)[1]

    def lost_at(self, gap: Array) -> tuple[Array, Array]:
        """`lost` and `jumped` after loading to each `gap` (m)."""
        return self.pressure.linear(self.lost, gap), self.pressure.linear(self.jumped, gap)

    def gap_at(self, pressure: Array) -> Array:
        """Gap (m) at which the pressure (Pa, not negative) has this value."""
        p = self.pressure
        rising = slice(int(np.flatnonzero(p.values > 0)[-1]) + 1, None, -1)
        inside = np.interp(pressure, p.values[rising], p.points[rising])
        _, most, slope = p(np.asarray(p.first))
        return np.asarray(inside + np.maximum(np.asarray(pressure) - most, 0.0) / slope)

    @cached_property
    def _energy(self) -> Tabulated:
        return replace(self.pressure, values=self.potential(self.pressure.points)[0])

    def energy_between_spheres(self, gap: float, radius: float) -> float:
        """Energy (J) of spheres with the reduced `radius` (m) and the smallest gap `gap` (m)."""
        end = self.pressure.last
        beyond = self._rest * end
        if gap >= end:
            integral = beyond * end / gap
        else:
            integral = self._energy.whole - float(self._energy(np.asarray(gap))[0]) + beyond
        return 2 * math.pi * radius * integral

    @cached_property
    def equilibrium(self) -> float:
        """Gap (m) at which the pressure is zero."""
        p = self.pressure
        k = int(np.flatnonzero(p.values > 0)[-1])
        here, there = p.values[k], p.values[k + 1]
        return float(p.first + p.step * (k + here / (here - there)))

    @cached_property
    def largest_tension(self) -> tuple[float, float]:
        """Gap (m) of the largest tension, and this tension (Pa)."""
        k = int(self.pressure.values.argmin())
        return float(self.pressure.first + k * self.pressure.step), -float(self.pressure.values[k])

    @cached_property
    def work(self) -> float:
        """Work of adhesion (J/m²) of the rough surfaces."""
        return -float(self.potential(np.array([self.equilibrium]))[0][0])
