"""The class `Case`: all tables of a case file, as data in SI units."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, Literal, cast

from pydantic import BeforeValidator, model_validator

from restitution.case import needs
from restitution.case.below_grid import Splitting, split_surface, splitting_of
from restitution.case.bodies import BodyTable
from restitution.case.impacts import MOST_IMPACTS, ImpactsTable
from restitution.case.interface import InterfaceTable, Yielding
from restitution.case.materials import Property, with_library_adhesion, work_of_adhesion
from restitution.case.models import Adhesion, adhesion_of
from restitution.case.quantities import Force, Length, Pressure
from restitution.case.roughness import GeneratedRoughness, MeasuredRoughness, Roughness
from restitution.case.rulebook import Input, key
from restitution.case.schema import GridTable, ImpactTable, Series, Table, UnloadingTable
from restitution.contact.bodies import Pair
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.contact import Contact, smooth
from restitution.contact.models import Adhesion as AdhesionModel
from restitution.contact.patch.law import PatchAttraction, PatchRepulsion
from restitution.display import quantity
from restitution.errors import CaseError, SurfaceError
from restitution.losses.half_space import HalfSpace
from restitution.losses.losses import Losses
from restitution.losses.plate import Plate
from restitution.losses.viscosity import Friction, Viscosity
from restitution.numerics.grid import Grid
from restitution.repeated.run_in import nominal_area
from restitution.surfaces import Surface, composite
from restitution.surfaces.refine import divided
from restitution.surfaces.split import SplitSurface
from restitution.theory import ThorntonNing

# Smallest width of a grid with [impacts], in diameters of the contact of smooth bodies.
_WIDEST = 1.6
# Tables that can prescribe the depths, which are states of loading. Each table prescribes one
# quantity: indentation, load, impact velocity or nominal pressure.
DEPTHS = ("indentation", "load", "impact", "pressure")


class Case(Table):
    """The content of a case file, in SI units."""

    title: str = key(
        "", "a text that appears in all results of the case", default="none", page=Input("Title")
    )
    total_error: bool = key(
        True, "`false` leaves out the additional curves that the [total error](error.md) needs"
    )
    maps: Literal["deepest", "all"] = key(
        "deepest",
        '`"all"` stores maps of pressure and plastic displacement at every depth in '
        "[`maps.nc`](results.md#maps-of-every-depth). They take up to 16 bytes of memory per "
        "node and depth; `check` states the size",
    )
    first: BodyTable
    second: BodyTable | None = None
    interface: InterfaceTable = InterfaceTable()
    roughness: Annotated[
        tuple[Roughness, ...],
        BeforeValidator(lambda value: tuple(value) if isinstance(value, list) else (value,)),
    ] = ()
    grid: GridTable = GridTable()
    indentation: Series[Length] | None = key(
        None, page=Input("Indentation", slider=(1e-10, 1e-4), initial=("20 nm", "2 um"))
    )
    load: Series[Force] | None = key(
        None, page=Input("Load", slider=(1e-9, 1e2), initial=("1 mN", "0.3 N"))
    )
    impact: ImpactTable | None = key(
        None, page=Input("Velocity", slider=(1e-4, 10.0), initial=("10 mm/s", "0.3 m/s"))
    )
    pressure: Series[Pressure] | None = None
    unloading: UnloadingTable = UnloadingTable()
    impacts: ImpactsTable | None = None

    @model_validator(mode="before")
    @classmethod
    def _with_adhesion(cls, value: Any) -> Any:
        return with_library_adhesion(value)

    @model_validator(mode="after")
    def _whole(self) -> Case:
        given = [name for name in DEPTHS if getattr(self, name) is not None]
        if len(given) != 1:
            which = f"[{'] and ['.join(given)}]" if given else "none of them"
            raise ValueError(
                "give one of the tables [indentation], [load], [impact] and [pressure]; this case "
                f"has {which}"
            )
        if self.periodic:
            self._check_period()
        elif self.pressure is not None:
            raise ValueError(
                "[pressure] is the nominal pressure of a periodic contact: add periodic = true to "
                "[grid], or give [load]"
            )
        if self.impact is not None:
            self._check_masses()
            if self.impact.oblique:
                self._check_oblique(self.impact)
        elastic = math.isinf(self.yielding().hardness)
        if self.interface.plasticity == "truncated" and elastic:
            raise ValueError(
                'interface.plasticity = "truncated" needs a yield_pressure, which is "elastic" '
                "here; give a pressure, or remove plasticity"
            )
        if self.grid.nodes is None:
            self._check_scan_brings_grid()
        factors, depths = len(self.factors()), len(self.depths())
        if factors != depths:
            raise ValueError(
                f"grid.refine: {factors} values for {depths} depths; give one for each depth, or "
                '"auto"'
            )
        if len({part.realisations for part in self.roughness} - {1}) > 1:
            raise ValueError(
                "roughness.realisations: differs between the tables; give the same number in all"
            )
        if self.impacts is not None:
            self._check_impacts(self.impacts)
        return self

    def _check_impacts(self, impacts: ImpactsTable) -> None:
        if self.impact is None:
            raise ValueError(
                "[impacts]: needs [impact], whose velocities are those at which COR is measured"
            )
        if not isinstance(self.grid.refine, int):
            raise ValueError("grid.refine: must be one number with [impacts]")
        if self.realisations > 1:
            raise ValueError(
                "roughness.realisations: must be 1 with [impacts], which measures COR at many "
                "places; remove this key"
            )
        for part in self.roughness:
            if isinstance(part, GeneratedRoughness) and not part.periodic:
                raise ValueError(
                    "roughness.periodic: must be true with [impacts], because the surface repeats "
                    "beyond its edges; remove this key"
                )
        if self.interface.plasticity == "truncated":
            raise ValueError(
                'interface.plasticity: "truncated" defines a single impact; remove this key to use '
                "[impacts]"
            )
        if impacts.place == "track" and all(body.radius for body in self.bodies().values()):
            raise ValueError(
                'impacts.place: "track" needs a wall; give second.radius = "flat", or place = '
                '"random"'
            )
        if (grid := self.grid.grid()) is not None:
            self.impact_counts(grid)

    def impact_counts(self, grid: Grid) -> dict[float, list[int]]:
        """Number of impacts on `grid` up to each coverage, by velocity (m/s) of [impact].

        Raises `CaseError` if a coverage is less than one contact, or needs too many impacts, or if
        a contact is as large as the grid.
        """
        impacts, impact = self.impacts, self.impact
        assert impacts is not None
        assert impact is not None
        counts, whole = {}, math.prod(grid.size)
        for V in impact.series():
            run_in = impacts.velocity or [V]
            areas = [nominal_area(self.pair(), self.yielding().hardness, v) for v in (V, *run_in)]
            _require_wide(grid, max(areas), max(V, *run_in))
            if impacts.count is not None:
                counts[V] = [impacts.count]
                continue
            one = sum(areas[1:]) / len(run_in) / whole
            counts[V] = [round(c / one) for c in sorted(set(impacts.coverage or []))]
            if counts[V][0] < 1:
                raise CaseError(
                    f"impacts.coverage: {min(impacts.coverage or []):g} is less than one contact "
                    f"at {V:.4g} m/s, which covers {one:.3g} of the surface; give at least "
                    f"{1.01 * one:.2g}, or a larger grid"
                )
            if counts[V][-1] > MOST_IMPACTS:
                raise CaseError(
                    f"impacts.coverage: {max(impacts.coverage or []):g} takes {counts[V][-1]} "
                    f"impacts at {V:.4g} m/s, more than {MOST_IMPACTS}; give less coverage, a "
                    "smaller grid, or higher velocities"
                )
        return counts

    def _check_period(self) -> None:
        for name, body in self.bodies().items():
            if body.radius is not None:
                raise ValueError(f'{name}.radius: must be "flat" if the grid is periodic')
            for loss in ("thickness", "loss_tangent", "relaxation_time"):
                if getattr(body, loss) is not None:
                    raise ValueError(
                        f"{name}.{loss}: acts in impacts only, and a periodic contact has none; "
                        "remove it"
                    )
        if self.impact is not None:
            raise ValueError(
                "[impact]: the bodies of a periodic contact have infinite mass; give "
                "[indentation], [load] or [pressure]"
            )
        if "unloading" in self.model_fields_set:
            raise ValueError(
                "[unloading]: a periodic case writes no unloading curves; remove this table"
            )
        self._check_attraction()
        yielding = self.yielding()
        if yielding.plasticity != "equilibrium":
            raise ValueError(
                "interface.yield_pressure: a periodic contact needs a constant yield pressure "
                'and plasticity = "equilibrium"; set yield_pressure to a pressure, "2.8 Y", '
                '"hardness" or "elastic"'
            )
        if not isinstance(self.grid.refine, int):
            raise ValueError("grid.refine: must be one number if the grid is periodic")
        if not self.roughness:
            raise ValueError(
                "roughness: is missing; smooth flat bodies touch everywhere, so add a table "
                "[roughness]"
            )
        if self.realisations > 1:
            raise ValueError(
                "roughness.realisations: a periodic case has one surface; remove this key"
            )
        for part in self.roughness:
            if isinstance(part, GeneratedRoughness) and not part.periodic:
                raise ValueError("roughness.periodic: must be true if the grid is periodic")
        highest = 0.0 if self.pressure is None else max(self.pressure.series())
        if highest >= yielding.hardness:
            raise ValueError(
                f"pressure: {1e-6 * highest:.4g} MPa is not below the yield pressure, "
                f"{1e-6 * yielding.hardness:.4g} MPa"
            )

    def _check_attraction(self) -> None:
        if self.interface.adhesive_energy == 0:
            return
        if self.interface.adhesion == "jkr":
            raise ValueError(
                'interface.adhesion: "jkr" is not defined for a periodic contact; use "cohesive"'
            )
        if self.indentation is None:
            raise ValueError(
                "interface.work_of_adhesion: a periodic contact with adhesion needs [indentation], "
                "because the indentation would jump at some values of a prescribed load or pressure"
            )

    def _check_masses(self) -> None:
        for name, body in self.bodies().items():
            if body.radius is not None and body.density is None:
                raise ValueError(
                    f"{name}.density: is missing; give it, because [impact] needs the mass"
                )

    def _check_oblique(self, impact: ImpactTable) -> None:
        key = "impact.spin" if impact.angle is None else "impact.angle"
        if self.interface.friction is None:
            raise ValueError(
                f"interface.friction: is missing; give it, because {key} needs a coefficient of "
                "friction"
            )
        if self.interface.adhesive_energy > 0:
            raise ValueError(
                f"{key}: oblique impacts are computed only for pairs without adhesion; remove "
                "this key, or interface.work_of_adhesion"
            )
        for (name, body), spin in zip(self.bodies().items(), impact.spins(), strict=True):
            if body.radius is None and spin != 0:
                raise ValueError(f'impact.spin: {name} is a wall and does not turn; give "0 rad/s"')

    def _check_scan_brings_grid(self) -> None:
        if len(self.roughness) == 1 and isinstance(self.roughness[0], MeasuredRoughness):
            if self.roughness[0].extend is None:
                return
            why = "roughness.extend does not define the size of the grid"
        elif self.roughness:
            why = "only a single measured surface defines its own grid"
        else:
            why = "only a measured surface defines its own grid"
        if "grid" not in self.model_fields_set:
            raise ValueError(f"the table [grid] is missing; give nodes and spacing, because {why}")
        raise ValueError(f"grid: nodes and spacing are missing; give both, because {why}")

    def bodies(self) -> dict[str, BodyTable]:
        """The tables of both bodies; if [second] is left out, it is the same as [first]."""
        return {"first": self.first, "second": self.second or self.first}

    @property
    def realisations(self) -> int:
        """Number of surfaces on which the case is computed."""
        return max((part.realisations for part in self.roughness), default=1)

    def realisation(self, number: int) -> Case:
        """Return the case with only one of its surfaces: `number`, counted from 0."""
        parts = tuple(
            part.variant(number) if part.realisations > 1 else part for part in self.roughness
        )
        return self.model_copy(update={"roughness": parts})

    def variant(self, number: int) -> Case:
        """Return this case with other surfaces, see `variant` of the tables."""
        return self.model_copy(
            update={"roughness": tuple(part.variant(number) for part in self.roughness)}
        )

    def has_library_values(self) -> bool:
        """Whether the materials library supplies any value, with its spread."""
        bodies = self.bodies().values()
        return self.library_adhesion() is not None or any(body.from_library() for body in bodies)

    def library_adhesion(self) -> Property[float] | None:
        """The work of adhesion of the materials library, if the case uses it."""
        first, second = (body.material for body in self.bodies().values())
        w = self.interface.work_of_adhesion
        if not w or first is None or second is None:
            return None
        try:
            known = work_of_adhesion(first, second)
        except CaseError:
            return None
        return known if known.value == w else None

    def refined(self, factor: int | tuple[int, ...]) -> Case:
        """Return this case on cells `factor` times smaller; a tuple has a factor for each depth."""
        return self.model_copy(update={"grid": self.grid.model_copy(update={"refine": factor})})

    def factors(self) -> list[int]:
        """Refinement factors of the grid, one for each depth; the shallowest comes first."""
        if isinstance(self.grid.refine, tuple):
            return list(self.grid.refine)
        return [self.grid.factor] * len(self.depths())

    def require_impact(self) -> None:
        """Raise `CaseError` for a periodic contact, which has no impact and no restitution."""
        if self.periodic:
            raise CaseError(
                "grid.periodic: a periodic contact has no restitution; give this case to "
                "`restitution run`, `check`, `surface` or `compare-theory`"
            )

    @property
    def periodic(self) -> bool:
        """Whether the contact is periodic."""
        return self.grid.periodic

    def pair(self) -> Pair:
        """The two bodies. Raises `CaseError` if both are flat and the grid is not periodic."""
        pair = Pair(*(table.body() for table in self.bodies().values()))
        if pair.flat and not self.periodic:
            if self.second is None:
                raise CaseError(
                    "first.radius: both bodies are flat, because [second] is left out and defaults "
                    'to [first]; add [second], or give [first] a radius such as "500 um"'
                )
            raise CaseError(
                "first.radius, second.radius: both bodies are flat; one must be a sphere"
            )
        return pair

    def losses(self) -> Losses:
        """Losses besides yielding and adhesion; a wall without density has no waves."""
        tables = self.bodies().values()
        pair = self.pair()
        wall = next((table for table in tables if table.radius is None), None)
        plate = waves = None
        if wall is not None and wall.density is not None:
            material = wall.youngs_modulus, wall.poissons_ratio, wall.density
            waves = HalfSpace(*material)
            plate = None if wall.thickness is None else Plate(wall.thickness, *material)
        bodies = tuple(
            (
                table.friction,
                pair.contact_modulus * (1 - table.poissons_ratio**2) / table.youngs_modulus,
            )
            for table in tables
        )
        viscous = any(friction != Friction() for friction, _ in bodies)
        return Losses(plate, waves, Viscosity(bodies) if viscous else None)

    def yielding(self) -> Yielding:
        """The yield model of the contact. Raises `CaseError` if a value for it is missing."""
        return self.interface.yielding(**self.bodies())

    def deepest_indentation(self) -> float:
        """The deepest indentation (m), by `indentation_at`."""
        return self.indentation_at(self.depths()[-1])

    def indentation_at(self, depth: float) -> float:
        """The indentation (m) at `depth`, one of `depths`: m, N, m/s or Pa.

        Without [indentation], that of smooth Thornton–Ning bodies; NaN for a periodic case.
        """
        pair = self.pair()
        if self.indentation is not None:
            return depth
        if self.periodic:
            return math.nan
        # The yield pressure p_y of elastic bodies is infinite, but ThorntonNing needs a finite
        # value. Use the contact modulus, a pressure that no contact reaches.
        p_y = min(self.yielding().hardness, pair.contact_modulus)
        smooth = ThorntonNing(pair.radius, pair.contact_modulus, p_y)
        if self.load is not None:
            return float(smooth.indentation(depth))
        assert pair.mass is not None  # checked by _check_masses
        return float(smooth.indentation_from_velocity(depth, pair.mass))

    @property
    def can_split(self) -> bool:
        """Whether the models and surfaces of the case are defined with waves below the grid."""
        interface = self.interface
        jkr = interface.adhesion == "jkr" or interface.needs_jkr
        if self.impacts or self.periodic or (interface.adhesive_energy and jkr):
            return False
        normal = all(part.is_normal for part in self.roughness)
        return normal and self.yielding().model.bounds_solve

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
        return PatchAttraction(surface.patches, surface.wavelength, Cohesive(w, z0))

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

    @property
    def prescribed(self) -> str:
        """Name of the table that prescribes the depths (states of loading)."""
        return next(name for name in DEPTHS if getattr(self, name) is not None)

    def depths(self) -> list[float]:
        """The prescribed indentations (m), loads (N), velocities (m/s) or pressures (Pa)."""
        tables = (self.indentation, self.load, self.impact, self.pressure)
        return next(table.series() for table in tables if table is not None)  # only one is given


def _require_wide(grid: Grid, area: float, velocity: float) -> None:
    """Raise `CaseError` if a contact of this area (m²) covers most of `grid`."""
    wide = _WIDEST * 2 * math.sqrt(area / math.pi)
    if wide <= min(grid.size):
        return
    nodes = math.ceil(wide / min(grid.spacing))
    raise CaseError(
        f"grid.nodes: the grid of {quantity(min(grid.size), 'm')} is too small for [impacts] at "
        f"{velocity:.4g} m/s, where the contact is {quantity(wide / _WIDEST, 'm')} wide; give at "
        f"least {nodes} nodes, or lower velocities"
    )
