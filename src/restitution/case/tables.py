"""The class `CaseTables`: all tables of a case file, as data in SI units."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, Self

from pydantic import (
    BeforeValidator,
    ModelWrapValidatorHandler,
    PrivateAttr,
    model_validator,
)

from restitution.case.bodies import BodyTable, losses_of
from restitution.case.impacts import ImpactsTable
from restitution.case.interface import InterfaceTable, Yielding
from restitution.case.materials import (
    Property,
    material,
    with_library_adhesion,
    work_of_adhesion,
)
from restitution.case.quantities import Force, Length, Pressure
from restitution.case.roughness import Roughness
from restitution.case.rulebook import Input, key
from restitution.case.schema import GridTable, ImpactTable, Series, Table, UnloadingTable
from restitution.contact.bodies import Pair
from restitution.errors import CaseError
from restitution.losses.losses import Losses
from restitution.theory import ThorntonNing

# Tables that can prescribe the depths, which are states of loading. Each table prescribes one
# quantity: indentation, load, impact velocity or nominal pressure.
DEPTHS = ("indentation", "load", "impact", "pressure")


class CaseTables(Table):
    """The tables of a case, and what follows from them without its surface."""

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

    _adheres_as_library: bool = PrivateAttr(default=False)

    @model_validator(mode="wrap")
    @classmethod
    def _with_adhesion(cls, value: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        completed = with_library_adhesion(value)
        case = handler(completed)
        if isinstance(value, dict):
            case._adheres_as_library = completed is not value
        return case

    def bodies(self) -> dict[str, BodyTable]:
        """The tables of both bodies; if [second] is left out, it is the same as [first]."""
        return {"first": self.first, "second": self.second or self.first}

    @property
    def realisations(self) -> int:
        """Number of surfaces on which the case is computed."""
        return max((part.realisations for part in self.roughness), default=1)

    def realisation(self, number: int) -> Self:
        """Return the case with only one of its surfaces: `number`, counted from 0."""
        parts = tuple(
            part.variant(number) if part.realisations > 1 else part for part in self.roughness
        )
        return self.model_copy(update={"roughness": parts})

    def variant(self, number: int) -> Self:
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
        if not self._adheres_as_library or first is None or second is None:
            return None
        known = work_of_adhesion(first, second)
        return known if known.value == w else None

    def library_size_effect(self) -> tuple[str, Property[float]] | None:
        """The softest material that yields and its h* in the library, if it has one."""
        names = {name: body.material for name, body in self.bodies().items()}
        yields = self.yielding().yields
        key = names["first" if yields == "both" else yields] if yields else None
        known = material(key).size_effect if key else None
        return None if key is None or known is None else (key, known)

    def refined(self, factor: int | tuple[int, ...]) -> Self:
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
        """Losses besides yielding and adhesion, by `losses_of`."""
        return losses_of(self.pair(), *self.bodies().values())

    def yielding(self) -> Yielding:
        """The yield model of the contact. Raises `CaseError` if a value for it is missing."""
        return self.interface.yielding(**self.bodies())

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
        assert pair.mass is not None  # checked with the other tables
        return float(smooth.indentation_from_velocity(depth, pair.mass))

    @property
    def prescribed(self) -> str:
        """Name of the table that prescribes the depths (states of loading)."""
        return next(name for name in DEPTHS if getattr(self, name) is not None)

    def depths(self) -> list[float]:
        """The prescribed indentations (m), loads (N), velocities (m/s) or pressures (Pa)."""
        tables = (self.indentation, self.load, self.impact, self.pressure)
        return next(table.series() for table in tables if table is not None)  # only one is given
