"""Load periodic patches without attraction: their pressure and energies against the gap."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.equilibrium import solve_nonadhesive
from restitution.contact.models import Plasticity
from restitution.contact.patch.growth import PatchBounds
from restitution.contact.patch.stored import bodies_in_words, kept
from restitution.contact.state import Array, State
from restitution.errors import DomainError
from restitution.numerics.tabulated import Tabulated

# Indentations of a patch, divided by the mean gap at first touch, at which an elastic patch without
# fluctuations of pressure would be complete. Beyond 1, yielding patches flow.
_INDENTATIONS = (*np.geomspace(0.02, 0.5, 14), *np.arange(0.6, 1.0, 0.08), 0.99)
_FLOWING = (*np.arange(1.1, 2.0, 0.15), 2.5, 3.5)
_COMPLETE = 0.985  # a patch ends at this fraction of its yield pressure
# Between elastic bodies at the same indentation, the nominal pressure of a patch is between that of
# an elastic patch at the same gap and that of the yielding patch: their geometric mean.
_GIVEN, _PASSES = 0.5, 2
_CELLS = 1024  # of the table
_FLAT = 1e-6  # least slope of the pressure beyond the table, in units of its mean slope
_TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class PatchCurve:
    """A patch from first touch to its deepest state; arrays against decreasing gap.

    `gap` (m) is the distance of the mean planes before deformation, `pressure` (Pa) the nominal
    pressure, `stored` the elastic energy per area (J/m²), `area` the relative contact area, and
    `separation` the gap (m) at which unloading ends. `bound_ratio` is the mean bound of the patch
    divided by that of smooth bodies, where this is `smooth_bound` (Pa).
    """

    gap: Array
    pressure: Array
    stored: Array
    area: Array
    separation: Array
    smooth_bound: Array
    bound_ratio: Array

    @classmethod
    def of(cls, contact: Contact, plasticity: Plasticity) -> PatchCurve:
        """Load `contact`, an elastic periodic contact, whose asperities yield by `plasticity`."""
        models = bodies_in_words(contact.pair), plasticity
        return cls(**kept(contact.surface, models, lambda: _columns(contact, plasticity)))

    def at(self, gap: Array) -> tuple[Array, Array, Array, Array]:
        """Pressure, elastic energy, area and distance to separation at each `gap` (m)."""
        from scipy.interpolate import PchipInterpolator

        inside = np.clip(gap, self.gap[-1], self.gap[0])
        # The pressure of the first asperities grows as the 1.5th to 3rd power of the overlap.
        root = PchipInterpolator(self.gap[::-1], np.cbrt(self.pressure[::-1]))
        energy = PchipInterpolator(self.gap[::-1], np.cbrt(self.stored[::-1]))
        area = PchipInterpolator(self.gap[::-1], self.area[::-1])
        end = PchipInterpolator(self.gap[::-1], (self.separation - self.gap)[::-1])
        return root(inside) ** 3, energy(inside) ** 3, area(inside), end(inside)


def _columns(contact: Contact, plasticity: Plasticity) -> dict[str, Array]:
    touch, nominal = float(contact.gap.mean()), math.prod(contact.grid.size)
    rows, bounds = [(touch, 0.0, 0.0, 0.0, touch)], None
    if plasticity.grows:
        bounds = PatchBounds.of(contact, plasticity, [s * touch for s in _INDENTATIONS])
    for state in _states(contact, plasticity, touch, bounds):
        at = touch - state.separation_indentation
        row = state.nominal_pressure, state.stored_energy / nominal, state.relative_area
        rows.append((touch - state.indentation, *row, at))
    names = "gap", "pressure", "stored", "area", "separation"
    columns = dict(zip(names, np.array(rows).T, strict=True))
    smooth, ratio = (np.ones(1), np.ones(1)) if bounds is None else bounds.of_mean()
    return columns | {"smooth_bound": smooth, "bound_ratio": ratio}


def _states(
    contact: Contact, plasticity: Plasticity, touch: float, bounds: PatchBounds | None
) -> Iterator[State]:
    flowing = _FLOWING if math.isfinite(plasticity.hardness) else ()
    given = 1.0
    for depth in touch * np.array([*_INDENTATIONS, *flowing]):
        try:
            if bounds is None:
                limit: Array | float = plasticity.hardness
                state = solve_nonadhesive(contact, depth, limit, _TOLERANCE)
            else:
                elastic = bounds.elastic(depth)
                for _ in range(_PASSES):
                    limit = bounds.at(depth, elastic * given**_GIVEN)
                    state = solve_nonadhesive(contact, depth, limit, _TOLERANCE)
                    given = state.nominal_pressure / elastic
        except DomainError:  # the contact of elastic bodies is complete
            return
        yield state
        if state.nominal_pressure > _COMPLETE * np.mean(limit):
            return


@dataclass(frozen=True, eq=False)
class RepulsionTable:
    """The mean of several patches at equal gaps, as functions of the gap.

    Attributes:
        pressure: Nominal pressure (Pa) during loading.
        lost: Share of the work of loading that yielding dissipates.
        area: Relative contact area.
        range: Distance (m) from the gap of a loaded patch to the gap where its unloading ends.
        smooth_bound: Bounds of smooth bodies (Pa), ascending.
        bound_ratio: Mean bound of the patches divided by each `smooth_bound`.
    """

    pressure: Tabulated
    lost: Array
    area: Array
    range: Array
    smooth_bound: Array
    bound_ratio: Array

    @classmethod
    def of(cls, curves: Sequence[PatchCurve], *, elastic: bool = False) -> RepulsionTable:
        """The mean of `curves`, down to the largest of their smallest gaps."""
        first, last = max(c.gap[-1] for c in curves), max(c.gap[0] for c in curves)
        gap = np.linspace(first, last, _CELLS + 1)
        p, stored, area, length = np.mean([c.at(gap) for c in curves], axis=0)
        pressure = Tabulated(first, (last - first) / _CELLS, p)
        work = _work(pressure, gap)[0]
        share = np.divide(stored, work, out=np.ones_like(work), where=work > 0)
        lost = np.clip(1 - share, 0.0, 0.0 if elastic else 1.0)
        lost[-1] = lost[-2]
        ratio = np.mean([c.bound_ratio for c in curves], axis=0)
        length = np.maximum(length, 1e-6 * (last - first))
        return cls(pressure, lost, area, length, curves[0].smooth_bound, ratio)

    def bulk_bound(self, smooth: Array) -> Array:
        """Bound of the nominal pressure (Pa) where smooth bodies have the bound `smooth` (Pa).

        It can be above the pressures of the table: on asperities of the long waves, the strain is
        larger than in a patch that flows. Asperities that yield late do not delay the bulk.
        """
        ratio = np.interp(smooth, self.smooth_bound, self.bound_ratio)
        return np.asarray(smooth * np.minimum(ratio, 1.0))

    @property
    def touch(self) -> float:
        """Gap (m) at first touch."""
        return self.pressure.last

    def work(self, gap: Array) -> tuple[Array, Array, Array]:
        """Work of loading (J/m²), pressure (Pa) and its derivative (Pa/m) at each `gap` (m)."""
        return _work(self.pressure, gap)

    def drawn(self, count: int) -> Array:
        """`count` gaps (m) that show the law."""
        return np.asarray(np.linspace(self.pressure.first, self.touch, count))

    def at(self, gap: Array) -> Array:
        """Pressure (Pa) at each `gap` (m)."""
        return self.work(gap)[1]

    def of_gap(self, values: Array, gap: Array) -> Array:
        """One of the arrays of the table, at each `gap` (m)."""
        return self.pressure.linear(values, gap)

    def gap_at(self, pressure: Array | float) -> Array:
        """Gap (m) at which loading reaches `pressure` (Pa, positive)."""
        p = self.pressure
        gap = np.interp(pressure, p.values[::-1], p.points[::-1])
        _, least, slope = p(np.asarray(p.first))
        beyond = np.maximum(np.asarray(pressure) - least, 0.0)
        flat = -_FLAT * least / (p.last - p.first)  # a patch that flows has no slope there
        return np.asarray(gap + beyond / np.minimum(slope, flat))


def _work(pressure: Tabulated, gap: Array) -> tuple[Array, Array, Array]:
    inside = np.minimum(gap, pressure.last)
    integral, p, slope = pressure(inside)
    touching = gap < pressure.last
    return pressure.whole - integral, np.where(touching, p, 0.0), np.where(touching, slope, 0.0)
