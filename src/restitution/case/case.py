"""The class `Case`: the tables of a case file that fit each other, its surface and contact."""

from __future__ import annotations

import math
from pathlib import Path
from typing import cast

from pydantic import model_validator

from restitution.case import needs
from restitution.case.below_grid import Splitting, split_surface, splitting_of
from restitution.case.checks import check_tables
from restitution.case.measured import MeasuredRoughness
from restitution.case.models import Adhesion, adhesion_of
from restitution.case.tables import CaseTables
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.contact import Contact, smooth
from restitution.contact.models import Adhesion as AdhesionModel
from restitution.contact.patch.law import PatchAttraction, PatchRepulsion
from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, composite
from restitution.surfaces.refine import divided
from restitution.surfaces.split import SplitSurface


class Case(CaseTables):
    """The content of a case file, in SI units."""

    @model_validator(mode="after")
    def _whole(self) -> Case:
        check_tables(self)
        return self

    def splitting(self, folder: Path) -> Splitting | None:
        """How waves below the grid are put into patches; None if they are not."""
        return splitting_of(self, folder)

    def surface(self, folder: Path) -> Surface:
        """Make the composite roughness on the grid; file names are relative to `folder`.

        With waves below the grid, it is a `SplitSurface`.
        """
        grid, factor = self.grid.grid(), self.grid.factor
        if grid is None:
            (scan,) = cast(tuple[MeasuredRoughness], self.roughness)  # `_whole` requires one scan
            return scan.surface(None, folder, factor)
        if not self.roughness:
            return smooth(divided(grid, factor))
        parts, how = [], self.splitting(folder)
        for number, part in enumerate(self.roughness, 1):
            try:
                parts.append(part.surface(grid, folder, factor, patches=how is not None))
            except SurfaceError as error:
                if len(self.roughness) == 1:
                    raise
                raise SurfaceError(f"table {number} of [[roughness]]: {error}") from error
        whole = composite(parts)
        return whole if how is None else split_surface(self, folder, whole, how)

    def contact(self, folder: Path) -> Contact:
        """Make the unloaded contact of the case; file names are relative to `folder`.

        Raises `CaseError` if a run needs more memory than is available.
        """
        self.pair()  # refuse two flat bodies before making a surface
        if grid := self.grid.grid():
            fine = divided(grid, self.grid.factor)
            self._require_memory(fine)
        return self.contact_on(self.surface(folder))

    def contact_on(self, surface: Surface) -> Contact:
        """Make the unloaded contact on the given `surface`. Raises the same errors as `contact`."""
        self._require_memory(surface.grid)
        return Contact(
            self.pair(),
            surface,
            **self.yielding().arguments(),
            adhesion=self._interface_on(surface),
            periodic=self.periodic,
        )

    def _interface_on(self, surface: Surface) -> AdhesionModel | None:
        if not isinstance(surface, SplitSurface):
            return self.adhesion_on(surface.grid)
        w, z0 = self.interface.adhesive_energy, self.interface.equilibrium_separation
        if w == 0:
            return PatchRepulsion(surface.patches, surface.wavelength)
        law = Cohesive(w, z0)
        return PatchAttraction(surface.patches, surface.wavelength, law, place=surface.place)

    def adhesion_on(self, grid: Grid) -> AdhesionModel | None:
        """The model of adhesion on `grid`; None without adhesion."""
        interface = self.interface
        return adhesion_of(
            self._adhesion_on(grid),
            interface.adhesive_energy,
            interface.approach,
            interface.detachment,
            interface.equilibrium_separation,
        )

    def _adhesion_on(self, grid: Grid) -> Adhesion:
        """By default "cohesive", if cells are fine and no other key needs "jkr"."""
        interface = self.interface
        if interface.adhesion is not None:
            return interface.adhesion
        w, z0 = interface.adhesive_energy, interface.equilibrium_separation
        if w == 0 or (interface.needs_jkr and not self.periodic):
            return "jkr"
        needed = Cohesive(w, z0).coarsest_spacing(self.pair())
        fine = self.periodic or max(grid.spacing) <= needed
        return "cohesive" if fine else "jkr"

    def _require_memory(self, grid: Grid) -> None:
        maps, needed = self.maps_bytes(grid), self.run_bytes(grid)
        needs.require(needed - maps, grid)
        if maps:
            needs.require_maps(needed, len(self.depths()))

    def maps_bytes(self, grid: Grid) -> float:
        """Size (bytes) of stored maps; 0 if only the deepest, on `grid`, is stored."""
        if self.maps == "deepest":
            return 0.0
        finest = divided(grid, max(1, max(self.factors()) // self.grid.factor))
        yields = not math.isinf(self.yielding().hardness)
        return needs.maps_bytes(finest, len(self.depths()), yields=yields)

    def run_bytes(self, grid: Grid) -> float:
        """Memory (bytes) of a run on `grid`."""
        adhesion = self.adhesion_on(grid)
        attraction = 0.0 if adhesion is None else adhesion.bytes_per_node
        run = needs.run_bytes(grid, max(self.yielding().model.bytes_per_node, attraction))
        return run + self.maps_bytes(grid)
