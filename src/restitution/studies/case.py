"""The case file: what it may say, checked, and turned into bodies, surface and contact."""

from __future__ import annotations

import difflib
import math
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, Generic, Literal, Self, TypeVar, cast

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    model_validator,
)

from restitution.collision import UnloadingMethod
from restitution.contact.bodies import Body, Pair
from restitution.contact.contact import Approach, Contact, Plasticity, smooth
from restitution.contact.detachment import Detachment
from restitution.contact.separation import RESTITUTION_ERROR
from restitution.errors import CaseError, SurfaceError, shown
from restitution.numerics.grid import Grid
from restitution.studies.quantities import Angle, Density, Force, Length, Pressure, SurfaceEnergy
from restitution.surfaces import (
    Surface,
    generate_surface,
    level,
    place_on_grid,
    read_surface,
    refine,
)
from restitution.surfaces.generate import RoughnessKind

MOST_NODES = 2**27  # of a grid: more do not fit into the memory of common machines
MOST_STEPS = 10_000  # of a curve


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, populate_by_name=True)


def _two(value: Any) -> Any:
    """One value for both axes, or a list of two."""
    if not isinstance(value, list):
        return value, value
    if len(value) != 2:
        raise ValueError(f"{shown(value)} should be one value, or a list of two (for x and y)")
    return tuple(value)


Nodes = Annotated[int, Field(gt=0)]
PairOf = BeforeValidator(_two)


def _few_enough(nodes: tuple[int, int]) -> tuple[int, int]:
    if nodes[0] * nodes[1] > MOST_NODES:
        raise ValueError(
            f"{shown(nodes[0])} x {shown(nodes[1])} nodes are more than a grid may have "
            f"({MOST_NODES} in all); give fewer, or a larger spacing"
        )
    return nodes


def _flat_is_infinite(value: Any) -> Any:
    return None if value == "flat" else value


class BodyTable(_Table):
    """`[first]` and `[second]`."""

    radius: Annotated[Length | None, BeforeValidator(_flat_is_infinite)]
    youngs_modulus: Pressure
    poissons_ratio: Annotated[float, Field(gt=-1, le=0.5)]
    density: Density | None = None

    def body(self) -> Body:
        """The body this table describes."""
        radius = math.inf if self.radius is None else self.radius
        return Body(radius, self.youngs_modulus, self.poissons_ratio, self.density)


class InterfaceTable(_Table):
    """`[interface]`; omitted: elastic."""

    yield_pressure: Pressure | None = None
    plasticity: Plasticity = "equilibrium"
    work_of_adhesion: SurfaceEnergy = 0.0
    approach: Approach = "equilibrium"
    detachment: Detachment = "crack-closure"
    equilibrium_separation: Length = 0.3e-9

    @model_validator(mode="after")
    def _truncated_at(self) -> Self:
        if self.plasticity == "truncated" and self.yield_pressure is None:
            raise ValueError(
                'plasticity = "truncated" needs the pressure to cut at; give yield_pressure, or '
                "leave plasticity out for elastic bodies"
            )
        return self


class GeneratedRoughness(_Table):
    """`[roughness]` with `kind` exponential, gaussian or self-affine."""

    kind: RoughnessKind
    rms: Length
    seed: Annotated[int, Field(ge=0, lt=2**63)]
    correlation_length: Annotated[tuple[Length, Length], PairOf] | None = None
    lay: Angle = 0.0
    hurst: float | None = None
    rolloff: Length | None = None
    shortest: Length | None = None
    skewness: float = 0.0
    kurtosis: float = 3.0
    periodic: bool = True


class MeasuredRoughness(_Table):
    """`[roughness]` with `kind = "measured"`."""

    kind: Literal["measured"]
    file: Annotated[str, Field(min_length=1)]
    channel: Annotated[int, Field(ge=0)] | None = None
    detrend: Literal["none", "center", "tilt", "curvature"] = "none"
    size: Annotated[tuple[Length, Length], PairOf] | None = None
    undefined: Literal["error", "interpolate"] = "error"


Roughness = Annotated[GeneratedRoughness | MeasuredRoughness, Field(discriminator="kind")]


class GridTable(_Table):
    """`[grid]`; may be omitted for a measured surface, which brings its own."""

    nodes: Annotated[tuple[Nodes, Nodes], PairOf, AfterValidator(_few_enough)]
    spacing: Annotated[tuple[Length, Length], PairOf]
    refine: Literal[1, 2, 4, 8] = 1

    @model_validator(mode="after")
    def _not_too_fine(self) -> Self:
        nx, ny = self.nodes
        _few_enough((self.refine * nx, self.refine * ny))
        return self


Quantity = TypeVar("Quantity")


class Series(_Table, Generic[Quantity]):
    """`[indentation]` and `[load]`: a span with steps, or a list of values."""

    from_: Annotated[Quantity | None, Field(alias="from")] = None
    to: Quantity | None = None
    steps: Annotated[int, Field(gt=0, le=MOST_STEPS)] | None = None
    scale: Literal["log", "linear"] = "log"
    values: Annotated[list[Quantity], Field(min_length=1, max_length=MOST_STEPS)] | None = None

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        span = (self.from_, self.to, self.steps)
        if self.values is not None:
            if span != (None, None, None):
                raise ValueError("give either values or from, to and steps, not both")
        elif None in span:
            raise ValueError("give from, to and steps (or values = [...])")
        elif self.from_ == self.to:
            raise ValueError("from and to are the same; for one depth or load use values = [...]")
        elif not cast(float, self.from_) < cast(float, self.to):
            raise ValueError("from must be smaller than to")
        elif self.steps == 1:
            raise ValueError(
                "steps = 1 does not reach from one to the other; give at least 2, or for one depth "
                "or load use values = [...]"
            )
        return self

    def series(self) -> list[float]:
        """The values asked for, in SI units, increasing."""
        if self.values is not None:
            return sorted(cast(set[float], set(self.values)))
        space = np.geomspace if self.scale == "log" else np.linspace
        first, last = cast(float, self.from_), cast(float, self.to)
        return [float(v) for v in space(first, last, cast(int, self.steps))]


class UnloadingTable(_Table):
    """`[unloading]`: which curves are written, and how unloading is computed."""

    curves: Annotated[int, Field(ge=0, le=MOST_STEPS)] = 3
    steps: Annotated[int, Field(ge=4, le=MOST_STEPS)] = 16
    method: UnloadingMethod = "path"
    restitution_error: Annotated[float, Field(gt=0, lt=1)] = RESTITUTION_ERROR


class Case(_Table):
    """A whole case file, in SI units."""

    title: str = ""
    first: BodyTable
    second: BodyTable | None = None
    interface: InterfaceTable = InterfaceTable()
    roughness: Roughness | None = None
    grid: GridTable | None = None
    indentation: Series[Length] | None = None
    load: Series[Force] | None = None
    unloading: UnloadingTable = UnloadingTable()

    @model_validator(mode="after")
    def _whole(self) -> Case:
        if (self.indentation is None) == (self.load is None):
            which = "neither is" if self.load is None else "both are"
            raise ValueError(
                f"give one of the tables [indentation] and [load]; {which} in this case"
            )
        if self.grid is None and not isinstance(self.roughness, MeasuredRoughness):
            raise ValueError("the table [grid] is missing; only a measured surface brings its own")
        return self

    def pair(self) -> Pair:
        """The two bodies; `CaseError` when both are flat."""
        first = self.first.body()
        if math.isinf(first.radius) and self.second is None:
            raise CaseError(
                "first.radius: is flat, and the table [second] is left out and so defaults to "
                "[first]: both are flat; one must be a sphere: write [second]"
            )
        return Pair(first, first if self.second is None else self.second.body())

    def surface(self, folder: Path) -> Surface:
        """The composite roughness on the grid; files are relative to `folder`."""
        if self.grid is None:
            return self._scan(folder)
        grid = Grid(self.grid.nodes, self.grid.spacing)
        if self.roughness is None:
            surface = smooth(grid)
        elif isinstance(self.roughness, GeneratedRoughness):
            surface = generate_surface(grid, **dict(self.roughness))
        else:
            surface = place_on_grid(self._scan(folder), grid)
        return refine(surface, self.grid.refine)

    def _scan(self, folder: Path) -> Surface:
        assert isinstance(self.roughness, MeasuredRoughness)  # _whole
        scan = read_surface(
            folder / self.roughness.file,
            channel=self.roughness.channel,
            size=self.roughness.size,
            undefined=self.roughness.undefined,
        )
        # Levelled as a whole before any part is cut out: the form belongs to the scan.
        return level(scan, self.roughness.detrend)

    def contact(self, folder: Path) -> Contact:
        """Everything before the first solve; files are relative to `folder`."""
        return Contact(
            self.pair(),
            self.surface(folder),
            yield_pressure=self.interface.yield_pressure or math.inf,
            plasticity=self.interface.plasticity,
            work_of_adhesion=self.interface.work_of_adhesion,
            approach=self.interface.approach,
            detachment=self.interface.detachment,
        )

    def depths(self) -> list[float]:
        """The indentations (m) or loads (N) asked for, increasing."""
        table = self.indentation or self.load
        assert table is not None  # _whole
        return table.series()


def read_case(path: Path) -> tuple[Case, str]:
    """Read and check a case file; return it with its text. Raises `CaseError`, naming the key."""
    try:
        text = path.read_text(encoding="utf-8-sig")  # editors on Windows write a byte order mark
    except UnicodeDecodeError:
        raise CaseError(f"{path}: is not a text file; a case file is TOML in UTF-8") from None
    except OSError as error:
        raise CaseError(f"{path}: cannot be read ({error.strerror}); name a case file") from None
    with naming(path):
        return parse_case(text), text


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Put the name of the case file before what is wrong with what it describes."""
    try:
        yield
    except (CaseError, SurfaceError) as error:
        raise type(error)(f"{path}: {error}") from error


def parse_case(text: str) -> Case:
    """Check the text of a case file. Raises `CaseError`, naming the key."""
    try:
        content = tomllib.loads(text)
    except RecursionError:
        raise CaseError("not valid TOML: nested too deeply; correct the brackets") from None
    except tomllib.TOMLDecodeError as error:
        raise CaseError(f"not valid TOML: {error}") from None
    except ValueError:  # Python refuses to read an integer of more than 4300 digits
        raise CaseError("holds a number of thousands of digits; correct it") from None
    try:
        return Case.model_validate(content)
    except ValidationError as error:
        # A key that is not known explains one that is missing, not the other way round.
        problems = error.errors(include_url=False)
        problems.sort(key=lambda problem: problem["type"] != "extra_forbidden")
        others = {_key_of(problem) for problem in problems} - {_key_of(problems[0])}
        more = f" (and {len(others)} more)" if others else ""
        raise CaseError(_in_words(problems[0]) + more) from None


# pydantic's kinds of problem in the words of a case file.
_WORDS = {
    "model_type": "a table",
    "model_attributes_type": "a table",
    "dict_type": "a table",
    "list_type": "a list",
    "too_short": "a list with at least one value",
    "too_long": f"a list with at most {MOST_STEPS} values",
    "string_type": "a text",
    "string_too_short": "a text that is not empty",
    "bool_type": "true or false",
    "float_type": "a number",
    "int_type": "a whole number",
    "int_parsing_size": "a smaller number",
}


def _keys(problem: Any) -> list[str]:
    # The tags of a union ("gaussian") and the places in a list are not keys of the file.
    tags = {"exponential", "gaussian", "measured"}
    return [str(k) for k in problem["loc"] if isinstance(k, str) and k not in tags]


def _key_of(problem: Any) -> str:
    return ".".join(shown(key)[1:-1] for key in _keys(problem))


def _in_words(problem: Any) -> str:
    """One line for one of pydantic's problems: the key, what is wrong, the remedy."""
    keys, key = _keys(problem), _key_of(problem)
    prefix = f"{key}: " if key else ""
    kind, context = problem["type"], problem.get("ctx", {})
    if kind == "extra_forbidden":
        known = _keys_of(keys[:-1], problem["loc"])
        near = difflib.get_close_matches(keys[-1], known, n=1)
        hint = f'did you mean "{near[0]}"?' if near else f"known keys: {', '.join(known)}"
        return f"{key}: unknown key; {hint}"
    if kind == "missing":
        what = f"the table [{key}]" if len(keys) == 1 else f'the key "{key}"'
        return f"{what} is missing"
    if kind == "union_tag_not_found":
        return f'{key}.kind is missing; write "exponential", "gaussian" or "measured"'
    if kind == "union_tag_invalid":
        return f"{key}.kind: {shown(context['tag'])} is not one of {context['expected_tags']}"
    if kind == "value_error":
        return f"{prefix}{context['error']}"
    should_be = _WORDS.get(kind, problem["msg"].removeprefix("Input should be "))
    return f"{prefix}{shown(problem['input'])} should be {should_be}"


def _keys_of(path: list[str], loc: tuple[Any, ...]) -> list[str]:
    """The keys that the table at `path` knows, as written in the file."""
    tables: dict[str, type[_Table]] = {
        "first": BodyTable, "second": BodyTable, "interface": InterfaceTable, "grid": GridTable,
        "indentation": Series[Length], "load": Series[Force], "unloading": UnloadingTable,
        "roughness": MeasuredRoughness if "measured" in loc else GeneratedRoughness,
    }  # fmt: skip
    model = tables[path[0]] if path else Case
    return [field.alias or name for name, field in model.model_fields.items()]
