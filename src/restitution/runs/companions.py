"""Companion curves of a run: additional curves that show how COR changes with the input.

All are computed on cells twice as large, in about a fifth of the time of the run. The first has the
surface and the materials of the run, and is compared with the run; the others have another surface
or other materials, and are compared with the first. COR is compared at equal impact velocity.

Where each unloading follows a path, the first has impacts near those of the run, and the others up
to three; only these are compared.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Self

import numpy as np

from restitution.case.below_grid import Splitting, split_surface
from restitution.case.bodies import BodyTable
from restitution.case.case import Case
from restitution.case.interface import Yielding
from restitution.contact.bodies import Pair
from restitution.contact.contact import Contact, smooth
from restitution.contact.interface import interface_of
from restitution.contact.models import COMPANION
from restitution.contact.patch.law import PatchAttraction, PatchLaw, law_of_patches
from restitution.curve.columns import Array
from restitution.curve.follow import Impact
from restitution.curve.point import Point
from restitution.curve.work_curve import WorkCurve
from restitution.errors import CaseError
from restitution.runs.companion_curves import (
    curve_of,
    impacts_around,
    impacts_of,
    loads_at,
    work_curve,
)
from restitution.runs.log import Say, ignore
from restitution.runs.scale_curves import ScaleCurves
from restitution.surfaces.refine import coarsen

ENDS = ("low", "high")  # of the spread of a library value
SURFACES = 7  # number of additional surfaces from which the scatter is estimated
_MOST_PATHS = 3  # largest number of impacts of other companion curves that follow a path

_DEVIATIONS = 2.0  # of a joined spectrum of scans

# Error of a bound that grows if patches have one of their own, beside that of a fine grid.
_OF_GROWTH = 0.06


@dataclass(frozen=True)
class Companions:
    """The companion curves of `case`, whose impacts have these `depths` (m) and `works` (J).

    Its files are relative to `folder`. Only contacts whose unloading follows a path need `works`.
    """

    case: Case
    folder: Path
    depths: Sequence[float]
    works: Sequence[float] = ()

    @classmethod
    def of(cls, case: Case, folder: Path, points: Sequence[Point]) -> Self:
        """The companion curves of `case` with the impacts `points`."""
        depths = sorted(point.indentation for point in points)
        return cls(case, folder, depths, [point.loading_work for point in points])

    @cached_property
    def coarse(self) -> Contact:
        """The contact of the case on cells twice as large, with patches of waves twice as long."""
        return self._coarse(self.case)

    @cached_property
    def own(self) -> WorkCurve:
        """The curve of `coarse`."""
        return work_curve(self._own_impacts)

    @cached_property
    def reference(self) -> WorkCurve:
        """The impacts of `own` with which those of other curves are compared."""
        return work_curve(self._compared) if self._follows_paths else self.own

    def weaker(self, factors: Array) -> WorkCurve:
        """The curve of `coarse` with its yield limit times `factors`, one for each depth.

        Where unloading follows a path, the limit is times the smallest factor at all depths.
        """
        coarse = self.coarse
        if self._follows_paths:
            factors = factors.min(keepdims=True)
        lowered = [
            replace(coarse, plasticity=coarse.plasticity.scaled(factor)) for factor in factors
        ]
        if all(contact == coarse for contact in lowered):
            return self.reference
        if self._follows_paths:
            return self.curve(lowered[0])
        return work_curve(impacts_of(loads_at(lowered, self.depths), self.case.unloading.method))

    def others(self, progress: Say = ignore) -> list[WorkCurve]:
        """Curves of other surfaces of the same kind (other seeds or places of the scan)."""
        for number in range(1 + len(self._others), SURFACES + 1):
            progress(f"error: surface {number} of {SURFACES}")
            self._others.append(self._curve(self._coarse(self.case.variant(number))))
        return self._others

    def spectra(self, progress: Say = ignore) -> list[WorkCurve]:
        """Curves with joined spectra of scans at both ends of their uncertainty; none without."""
        if not self._spectra and any(part.kind == "joined" for part in self.case.roughness):
            progress("error: joined spectrum")
            self._spectra.extend(
                self._curve(self._coarse(with_deviations(self.case, number)))
                for number in (-_DEVIATIONS, _DEVIATIONS)
            )
        return self._spectra

    def scales(self, progress: Say = ignore) -> ScaleCurves | None:
        """Curves that show the errors of waves below the grid; None without such waves."""
        if not self._scales:
            law, how = law_of_patches(self.coarse), self.case.splitting(self.folder)
            if law is None or how is None:
                return None
            self._scales.append(self._scale_curves(law, how, progress))
        return self._scales[0]

    def _scale_curves(self, law: PatchLaw, how: Splitting, progress: Say) -> ScaleCurves:
        single, coarse, weaker, without = [], self.coarse, None, None
        for number, patch in enumerate(law.patches, 1):
            progress(f"error: patch {number} of {len(law.patches)}")
            alone = replace(law, patches=(patch,))
            single.append(self.curve(replace(coarse, adhesion=alone)))
        if coarse.plasticity.grows:
            weak = replace(coarse, plasticity=coarse.plasticity.scaled(1 - _OF_GROWTH))
            weaker = self.curve(weak)
        if not law.attracts:
            without = self.curve(replace(coarse, adhesion=None))
        edge = 0.0 if isinstance(law, PatchAttraction) else how.nodes * how.cell
        return ScaleCurves(self.reference, tuple(single), weaker, without, edge, how.wavelength)

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
    def _spectra(self) -> list[WorkCurve]:
        return []

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
            change = [np.abs(values - self.own.at(work)) for values in moved]
            changes.append(np.max(change, axis=0))
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
        return [(self.coarse, self.reference)]

    @cached_property
    def _own_impacts(self) -> list[Impact]:
        if self._follows_paths:
            return impacts_around(self.coarse, self._own_works, self.case.unloading.method)
        loads = loads_at([self.coarse] * len(self.depths), self.depths)
        return impacts_of(loads, self.case.unloading.method)

    @property
    def _own_works(self) -> list[float]:
        """The works around which `own` has impacts: below the first, and beyond each of the others.

        With the spread of densities, the mass of the bodies moves both ends.
        """
        works, mass = self._works, self.coarse.pair.mass
        ratios = [m / mass for case in self._ends if mass and (m := case.pair().mass)]
        low, high = min([1.0, *ratios]), max([1.0, *ratios])
        return [low * works[0], *works[:-1], high * works[-1]] if works else []

    @property
    def _works(self) -> list[float]:
        return sorted(work for work in self.works if work > 0)

    @property
    def _follows_paths(self) -> bool:
        return interface_of(self.coarse).follows_path and self.case.unloading.method == "path"

    @property
    def _compared(self) -> list[Impact]:
        """The first impact of `_own_impacts`, and those near the works of other curves."""
        works = self._own_works[1:]
        near = _compared_works(works)[1:] or works
        known = self._own_impacts
        return known[:1] + [impact for impact in known[1:] if impact.load.prescribed in near]

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
        if self._follows_paths:
            works = _compared_works(self._works)
            return work_curve(impacts_around(contact, works, self.case.unloading.method))
        return curve_of(contact, self.depths, self.case.unloading.method)


def _compared_works(works: Sequence[float]) -> list[float]:
    """The first of the works, the last, and one in the middle."""
    at = np.linspace(0, len(works) - 1, min(_MOST_PATHS, len(works)))
    return [works[round(k)] for k in at]


def coarser_contact(contact: Contact) -> Contact:
    """`contact` on cells twice as large, without the shortest waves of its surface."""
    coarser = coarsen(contact.surface)
    if contact.surface.provenance.get("source") == "smooth":
        coarser = smooth(coarser.grid)
    # Bodies with other patches or materials may need finer cells.
    marked = replace(coarser, provenance={**coarser.provenance, COMPANION: True})
    return replace(contact, surface=marked)


def with_deviations(case: Case, number: float) -> Case:
    """`case` with joined spectra of scans raised by a `number` of standard deviations."""
    parts = tuple(
        part.model_copy(update={"deviations": part.deviations + number})
        if part.kind == "joined"
        else part
        for part in case.roughness
    )
    return case.model_copy(update={"roughness": parts})


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
