"""Companion curves of a run: additional curves that show how COR changes with the input.

All are computed on cells twice as large, in about a fifth of the time of the run. The first has the
surface and the materials of the run, and is compared with the run; the others have another surface
or other materials, and are compared with the first. COR is compared at equal impact velocity.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path

import numpy as np

from restitution.case.below_grid import Splitting, split_surface
from restitution.case.bodies import BodyTable
from restitution.case.case import Case
from restitution.case.interface import Yielding
from restitution.collision import UnloadingMethod
from restitution.contact.bodies import Pair
from restitution.contact.contact import Contact, smooth
from restitution.contact.interface import interface_of
from restitution.contact.loading import solve
from restitution.contact.models import COMPANION
from restitution.contact.patch.law import PatchAttraction, PatchLaw, law_of_patches
from restitution.contact.state import State
from restitution.curve.columns import Array
from restitution.curve.follow import Load, Unloading, follow
from restitution.curve.work_curve import WorkCurve
from restitution.errors import CaseError, DomainError, RestitutionError
from restitution.numerics.intervals import half_interval
from restitution.runs.log import Say, ignore
from restitution.surfaces.refine import coarsen

ENDS = ("low", "high")  # of the spread of a library value
SURFACES = 7  # number of additional surfaces from which the scatter is estimated
_TOLERANCE = 0.005  # allowed error of COR due to the steps of adhesive unloading

# A companion curve has two more depths than the run: the smallest depth times the first factor, and
# the largest depth times the second factor. They are needed because other surfaces reach the same
# loading work at other depths.
_SHALLOWER, _DEEPER = 0.5, 1.3

# Error of a bound that grows if patches have one of their own, beside that of a fine grid.
_OF_GROWTH = 0.08


def curve_of(
    contact: Contact,
    depths: Sequence[float],
    method: UnloadingMethod,
    tolerance: float = _TOLERANCE,
) -> WorkCurve:
    """Compute the curve of `contact` at `depths` (m) and at one more depth beyond each end.

    `tolerance` is the allowed error of COR due to the steps of adhesive unloading. A depth that
    cannot be solved is left out. The curve ends where the contact reaches the edge of the grid.
    """
    return _curve_of([contact] * len(depths), depths, method, tolerance)


def _curve_of(
    contacts: Sequence[Contact],
    depths: Sequence[float],
    method: UnloadingMethod,
    tolerance: float = _TOLERANCE,
) -> WorkCurve:
    loads = [
        Load(contact, partial(_solve, contact, depth), depth)
        for contact, depth in zip(
            (contacts[0], *contacts, contacts[-1]),
            (_SHALLOWER * depths[0], *depths, _DEEPER * depths[-1]),
            strict=True,
        )
    ]
    impacts = follow(loads, Unloading(method, tolerance=tolerance), _failed)
    return WorkCurve.of(impact.collision for impact in impacts)


def _failed(error: RestitutionError) -> bool:
    return not isinstance(error, DomainError)  # deeper contacts reach the edge of the grid, too


def _solve(contact: Contact, depth: float, start: State | None) -> State:
    # Only a loading path is long enough to be worth continuing.
    return solve(contact, depth, start=start if interface_of(contact).follows_path else None)


@dataclass(frozen=True)
class ScaleCurves:
    """Curves that show the errors of a law of patches.

    `single` has the curve of the law of each patch, and `weaker` that of weaker bodies if their
    bound grows. `edge` is that of a patch (m); 0 if asperities have their places in the contact, so
    that other surfaces show the scatter of such a sample.
    """

    own: WorkCurve
    single: tuple[WorkCurve, ...]
    weaker: WorkCurve | None
    edge: float

    @classmethod
    def of(
        cls, companions: Companions, law: PatchLaw, how: Splitting, progress: Say
    ) -> ScaleCurves:
        single, coarse, weaker = [], companions.coarse, None
        for number, patch in enumerate(law.patches, 1):
            progress(f"error: patch {number} of {len(law.patches)}")
            alone = replace(law, patches=(patch,))
            single.append(companions.curve(replace(coarse, adhesion=alone)))
        if coarse.plasticity.grows:
            weak = replace(coarse, plasticity=coarse.plasticity.scaled(1 - _OF_GROWTH))
            weaker = companions.curve(weak)
        edge = 0.0 if isinstance(law, PatchAttraction) else how.nodes * how.cell
        return cls(companions.own, tuple(single), weaker, edge)

    def error(self, quantity_of: Callable[[WorkCurve], Array], area: Array | float) -> Array:
        """Error of a quantity due to the scatter of patches, and to a bound that grows.

        The waves in the contact are one sample as large as its nominal `area` (m²).
        """
        own = quantity_of(self.own)
        growth = 0 * own
        if self.weaker is not None:
            growth = np.abs(quantity_of(self.weaker) - own)
        if len(self.single) < 2:
            return np.asarray(growth)
        deviation = np.std([quantity_of(curve) for curve in self.single], axis=0, ddof=1)
        sample = np.sqrt(self.edge**2 / np.maximum(area, 1e-300))
        scatter = deviation * np.hypot(half_interval(len(self.single)), sample)
        return np.asarray(np.hypot(scatter, growth))


@dataclass(frozen=True)
class Companions:
    """The companion curves of `case` at `depths` (m); its files are relative to `folder`."""

    case: Case
    folder: Path
    depths: Sequence[float]

    @cached_property
    def coarse(self) -> Contact:
        """The contact of the case on cells twice as large, with patches of waves twice as long."""
        return self._coarse(self.case)

    @cached_property
    def own(self) -> WorkCurve:
        return self._curve(self.coarse)

    def weaker(self, factors: Array) -> WorkCurve:
        """The curve of `coarse` with its yield limit times `factors`, one for each depth."""
        coarse = self.coarse
        lowered = [replace(coarse, plasticity=coarse.plasticity.scaled(f)) for f in factors]
        if all(contact == coarse for contact in lowered):
            return self.own
        return _curve_of(lowered, self.depths, self.case.unloading.method)

    def others(self, progress: Say = ignore) -> list[WorkCurve]:
        """Curves of other surfaces of the same kind (other seeds or places of the scan)."""
        for number in range(1 + len(self._others), SURFACES + 1):
            progress(f"error: surface {number} of {SURFACES}")
            self._others.append(self._curve(self._coarse(self.case.variant(number))))
        return self._others

    def scales(self, progress: Say = ignore) -> ScaleCurves | None:
        """Curves that show the errors of waves below the grid; None without such waves."""
        if not self._scales:
            law, how = law_of_patches(self.coarse), self.case.splitting(self.folder)
            if law is None or how is None:
                return None
            self._scales.append(ScaleCurves.of(self, law, how, progress))
        return self._scales[0]

    @property
    def cell_area(self) -> float:
        """Area (m²) of a cell of the run."""
        return self._own.grid.cell_area

    @property
    def area_at_pull_off(self) -> float:
        """Contact area (m²) of smooth bodies at pull-off, with the adhesion that is left."""
        law, pair = law_of_patches(self.coarse), self.coarse.pair
        return math.pi * pair.radius * law.length(pair) if law is not None else math.inf

    @cached_property
    def _scales(self) -> list[ScaleCurves]:
        return []

    @cached_property
    def _own(self) -> Contact:
        return self.case.contact(self.folder)

    def materials(self, work: Array) -> list[Array]:
        """Changes of COR at `work` (J) due to the spread of values from the material library.

        One change for each kind of value with a spread: elasticity, yield model, work of adhesion
        and density. The values of both bodies are set to the low, then to the high end; the larger
        change counts.
        """
        here, mass = self.curve(self.of_materials).at(work), self.coarse.pair.mass
        changes = []
        for ends in self.material_ends():
            low, high = (np.abs(self.curve(contact).at(work) - here) for contact in ends)
            changes.append(np.maximum(low, high))
        masses = [case.pair().mass for case in self._ends]
        if mass is not None and any(m != mass for m in masses):
            moved = [self.own.at(work * m / mass) for m in masses if m is not None]
            own = self.own.at(work)
            changes.append(np.max([np.abs(values - own) for values in moved], axis=0))
        return changes

    def material_ends(self) -> list[tuple[Contact, Contact]]:
        """Pairs of contacts with one kind of library value at either end of its spread."""
        ends = (self.stiffness_ends, self.strength_ends, self.adhesion_ends)
        return [pair for pair in ends if any(contact != self.of_materials for contact in pair)]

    @cached_property
    def of_materials(self) -> Contact:
        """`coarse`, with which those with other materials are compared; it has a single patch."""
        law = self.coarse.adhesion
        if not isinstance(law, PatchAttraction):
            return self.coarse
        return replace(self.coarse, adhesion=replace(law, patches=law.patches[:1]))

    @cached_property
    def stiffness_ends(self) -> tuple[Contact, Contact]:
        low, high = (self.with_modulus_of(case) for case in self._ends)
        return low, high

    @cached_property
    def strength_ends(self) -> tuple[Contact, Contact]:
        low, high = (self.with_yield_of(case) for case in self._ends)
        return low, high

    @cached_property
    def adhesion_ends(self) -> tuple[Contact, Contact]:
        known, adhesion = self.case.library_adhesion(), self.of_materials.adhesion
        if known is None or adhesion is None:
            return self.of_materials, self.of_materials
        low, high = (
            replace(self.of_materials, adhesion=adhesion.with_work_of_adhesion(w))
            for w in (known.low, known.high)
        )
        return low, high

    def with_modulus_of(self, case: Case) -> Contact:
        pair = _with_modulus_of(self.coarse.pair, case.pair())
        return replace(self.of_materials, pair=pair)

    def with_yield_of(self, case: Case) -> Contact:
        return replace(self.of_materials, **_yielding(case).arguments())

    def curve(self, contact: Contact) -> WorkCurve:
        """The curve of `contact`, computed once; `contact` is `coarse` with other materials."""
        for known, curve in self._curves:
            if known == contact:
                return curve
        self._curves.append((contact, self._curve(contact)))
        return self._curves[-1][1]

    @cached_property
    def _curves(self) -> list[tuple[Contact, WorkCurve]]:
        return [(self.coarse, self.own)]

    @cached_property
    def _others(self) -> list[WorkCurve]:
        return []

    @cached_property
    def _ends(self) -> list[Case]:
        return [moved(self.case, end) for end in ENDS]

    def _coarse(self, case: Case) -> Contact:
        contact, how = case.contact(self.folder), case.splitting(self.folder)
        law = law_of_patches(contact)
        if law is not None and how is not None:
            wide = replace(how, wavelength=2 * how.wavelength)
            surface = split_surface(case, self.folder, contact.surface, wide)
            other = replace(law, patches=surface.patches, wavelength=surface.wavelength)
            contact = replace(contact, surface=surface, adhesion=other)
        return coarser_contact(contact)

    def _curve(self, contact: Contact) -> WorkCurve:
        return curve_of(contact, self.depths, self.case.unloading.method)


def coarser_contact(contact: Contact) -> Contact:
    """`contact` on cells twice as large, without the shortest waves of its surface."""
    coarser = coarsen(contact.surface)
    if contact.surface.provenance.get("source") == "smooth":
        coarser = smooth(coarser.grid)
    new = replace(contact, surface=coarser)
    if interface_of(new).resolves_range(new):
        return new
    coarser = replace(coarser, provenance={**coarser.provenance, COMPANION: True})
    return replace(contact, surface=coarser)


def _with_modulus_of(pair: Pair, other: Pair) -> Pair:
    return Pair(
        *(
            replace(body, youngs_modulus=like.youngs_modulus, poissons_ratio=like.poissons_ratio)
            for body, like in ((pair.first, other.first), (pair.second, other.second))
        )
    )


def _yielding(case: Case) -> Yielding:
    """Yield model of `case`, or the default model if a value for the chosen model is missing."""
    try:
        return case.yielding()
    except CaseError:
        default = {"plasticity": None, "tangent_modulus": None}
        interface = case.interface.model_copy(update=default)
        return case.model_copy(update={"interface": interface}).yielding()


def moved(case: Case, end: str, body: str = "", key: str = "") -> Case:
    """`case` with values from the material library at one `end` ("low" or "high") of their spread.

    `body` ("first" or "second") and `key` select one value; by default all values are moved.
    """

    def of(name: str, table: BodyTable) -> BodyTable:
        known = table.from_library().items() if body in ("", name) else ()
        return table.model_copy(update={k: getattr(p, end) for k, p in known if key in ("", k)})

    second = of("second", case.second) if case.second else None
    return case.model_copy(update={"first": of("first", case.first), "second": second})
