"""The case file: its tables together, and what is said of one that is wrong."""

from __future__ import annotations

import difflib
import math
import re
import stat
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, cast

from pydantic import BeforeValidator, ValidationError, model_validator

from restitution.contact.bodies import Pair
from restitution.contact.contact import Contact, smooth
from restitution.contact.impact import solve_at_velocity
from restitution.contact.load import solve_at_force
from restitution.contact.loading import solve
from restitution.contact.state import State
from restitution.errors import CaseError, SurfaceError, shown
from restitution.numerics.grid import Grid
from restitution.studies import needs
from restitution.studies.particles import BodyTable, InterfaceTable, Yielding
from restitution.studies.quantities import Force, Length
from restitution.studies.table import Table
from restitution.studies.tables import (
    MOST_STEPS,
    CropTable,
    GeneratedRoughness,
    GridTable,
    ImpactTable,
    MeasuredRoughness,
    Roughness,
    Series,
    UnloadingTable,
)
from restitution.surfaces import Surface, composite
from restitution.surfaces.refine import divided


def _one_or_more(value: Any) -> Any:
    """One table, or a list of them."""
    return tuple(value) if isinstance(value, list) else (value,)


_LARGEST = 2**22  # bytes of a case file
_DEEPEST = 32  # tables and lists within each other, and parts of a key
_NAMED = 3  # further keys with a problem
DEPTHS = ("indentation", "load", "impact")  # the tables that may say how deep


class Case(Table):
    """A whole case file, in SI units."""

    title: str = ""
    total_error: bool = True
    first: BodyTable
    second: BodyTable | None = None
    interface: InterfaceTable = InterfaceTable()
    roughness: Annotated[tuple[Roughness, ...], BeforeValidator(_one_or_more)] = ()
    grid: GridTable | None = None
    indentation: Series[Length] | None = None
    load: Series[Force] | None = None
    impact: ImpactTable | None = None
    unloading: UnloadingTable = UnloadingTable()

    @model_validator(mode="after")
    def _whole(self) -> Case:
        given = [name for name in DEPTHS if getattr(self, name) is not None]
        if len(given) != 1:
            which = f"[{'] and ['.join(given)}] are" if given else "none of them is"
            raise ValueError(
                f"give one of the tables [indentation], [load] and [impact]; {which} in this case"
            )
        if self.impact is not None:
            self._check_masses()
        elastic = math.isinf(self.yielding().hardness)
        if self.interface.plasticity == "truncated" and elastic:
            raise ValueError(
                'interface.plasticity = "truncated" needs the pressure to cut at, and '
                'yield_pressure is "elastic"; give a pressure, or leave plasticity out'
            )
        if self._own_grid() is None:
            self._check_scan_brings_grid()
        if len({part.realisations for part in self.roughness} - {1}) > 1:
            raise ValueError("roughness.realisations: differs between the tables; give one number")
        return self

    def _check_masses(self) -> None:
        for name, body in (("first", self.first), ("second", self.second)):
            if body is not None and body.radius is not None and body.density is None:
                raise ValueError(f"{name}.density: is missing; an impact velocity needs it")

    def _check_scan_brings_grid(self) -> None:
        if len(self.roughness) == 1 and isinstance(self.roughness[0], MeasuredRoughness):
            if self.roughness[0].extend is None:
                return
            why = "roughness.extend says how a scan is continued, not how far"
        elif self.roughness:
            why = "only a single measured surface brings its own"
        else:
            why = "only a measured surface brings its own"
        if self.grid is None:
            raise ValueError(f"the table [grid] is missing; {why}")
        raise ValueError(f"grid: nodes and spacing are missing; {why}")

    def _own_grid(self) -> Grid | None:
        return None if self.grid is None else self.grid.grid()

    @property
    def realisations(self) -> int:
        """How many surfaces are to be made of this roughness."""
        return max((part.realisations for part in self.roughness), default=1)

    def realisation(self, number: int) -> Case:
        """This case with one surface, the `number`th (from 0): so much is added to the seeds."""
        parts = tuple(
            part.variant(number).model_copy(update={"realisations": 1})
            if part.realisations > 1
            else part
            for part in self.roughness
        )
        return self.model_copy(update={"roughness": parts})

    def variant(self, number: int) -> Case:
        """This case with another surface of the same kind: every part has another seed or place."""
        parts = tuple(
            part.variant(number).model_copy(update={"realisations": 1}) for part in self.roughness
        )
        return self.model_copy(update={"roughness": parts})

    def has_library_values(self) -> bool:
        """Whether a value of the bodies is the library's, which has a spread."""
        return any(body.from_library() for body in (self.first, self.second) if body is not None)

    def refined(self, factor: int) -> Case:
        """This case on cells `factor` times as small as [grid] says, whatever its `refine`."""
        grid = (self.grid or GridTable()).model_copy(update={"refine": factor})
        return self.model_copy(update={"grid": grid})

    def pair(self) -> Pair:
        """The two bodies; `CaseError` when both are flat."""
        first = self.first.body()
        if math.isinf(first.radius) and self.second is None:
            raise CaseError(
                "first.radius: is flat, and the table [second] is left out and so defaults to "
                "[first]: both are flat; one must be a sphere: write [second], or for [first] "
                'radius = "500 um"'
            )
        return Pair(first, first if self.second is None else self.second.body())

    def yielding(self) -> Yielding:
        """How the contact yields. Raises `CaseError` where what it needs is not known."""
        return self.interface.yielding(self.first, self.second or self.first)

    def surface(self, folder: Path) -> Surface:
        """The composite roughness on the grid; files are relative to `folder`."""
        grid, factor = self._own_grid(), 1 if self.grid is None else self.grid.factor
        if grid is None:
            (scan,) = cast(tuple[MeasuredRoughness], self.roughness)  # _whole
            return scan.surface(None, folder, factor)
        if not self.roughness:
            return smooth(divided(grid, factor))
        return composite([part.surface(grid, folder, factor) for part in self.roughness])

    def contact(self, folder: Path) -> Contact:
        """Everything before the first solve; files are relative to `folder`.

        Raises `CaseError` where a run takes more memory than there is.
        """
        pair = self.pair()
        if grid := self._own_grid():
            fine = divided(grid, self.grid.factor if self.grid else 1)
            needs.require(self.run_bytes(fine), fine)
        surface = self.surface(folder)
        needs.require(self.run_bytes(surface.grid), surface.grid)
        return Contact(
            pair,
            surface,
            **self.yielding().arguments(),
            work_of_adhesion=self.interface.adhesion,
            approach=self.interface.approach,
            detachment=self.interface.detachment,
        )

    def run_bytes(self, grid: Grid) -> float:
        """Memory that a run on `grid` takes."""
        yielding = self.yielding()
        plasticity = "none" if math.isinf(yielding.hardness) else yielding.plasticity
        adhesive = self.interface.adhesion > 0
        return needs.run_bytes(grid, plasticity=plasticity, adhesive=adhesive)

    def depths(self) -> list[float]:
        """The indentations (m), loads (N) or impact velocities (m/s) asked for, increasing."""
        table = self.indentation or self.load or self.impact
        assert table is not None  # _whole
        return table.series()

    def load_to(self, contact: Contact, depth: float, start: State | None = None) -> State:
        """The state of `contact` at one of these depths; `start` is that of a shallower one.

        Raises as `solve`, `solve_at_force` and `solve_at_velocity`.
        """
        if self.load is not None:
            return solve_at_force(contact, depth, start=start)
        if self.impact is not None:
            return solve_at_velocity(contact, depth, start=start)
        return solve(contact, depth, start=start)


def read_case(path: Path) -> tuple[Case, str]:
    """Read and check a case file; return it with its text. Raises `CaseError`, naming the key."""
    text = read_text(path)
    with naming(path):
        return parse_case(text), text


def read_text(path: Path) -> str:
    """The text of a case file. Raises `CaseError`, naming the file."""
    try:
        kind = path.stat()
        if not (stat.S_ISREG(kind.st_mode) or stat.S_ISDIR(kind.st_mode)):
            raise CaseError(
                f"{path}: is not a regular file (a device, pipe or socket); name a case file"
            )
        if kind.st_size > _LARGEST:
            raise CaseError(
                f"{path}: has {kind.st_size} bytes, more than the {_LARGEST} a case file may have; "
                "name a case file"
            )
        return path.read_text(encoding="utf-8-sig")  # editors on Windows write a byte order mark
    except UnicodeDecodeError:
        raise CaseError(f"{path}: is not a text file; a case file is TOML in UTF-8") from None
    except OSError as error:
        raise CaseError(f"{path}: cannot be read ({error.strerror}); name a case file") from None


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Put the name of the case file before what is wrong with what it describes."""
    try:
        yield
    except (CaseError, SurfaceError) as error:
        raise type(error)(f"{path}: {error}") from error


def parse_toml(text: str) -> dict[str, Any]:
    """The tables of a TOML file. Raises `CaseError`."""
    try:
        _check_dots(text)
        content = tomllib.loads(text)
        _check_depth(content)
        return content
    except CaseError:  # a ValueError, too
        raise
    except RecursionError:
        raise _too_deep() from None
    except tomllib.TOMLDecodeError as error:
        raise CaseError(f"not valid TOML: {error}") from None
    except ValueError:  # Python refuses to read an integer of more than 4300 digits
        raise CaseError("holds a number of thousands of digits; correct it") from None


def _too_deep() -> CaseError:
    return CaseError("not valid TOML: nested too deeply; correct the brackets or the dotted keys")


def _check_dots(text: str) -> None:
    """Refuse keys of very many parts, for which the reader of TOML takes minutes."""
    for word in re.split(r"[^\w.\-\"']+", text):
        if word.count(".") > _DEEPEST and ".." not in word.strip("."):
            raise _too_deep()


def _check_depth(content: dict[str, Any]) -> None:
    """Refuse tables so deep that showing them would fail."""
    level: list[Any] = [content]
    for _ in range(_DEEPEST):
        inner = [v.values() if isinstance(v, dict) else v for v in level]
        level = [v for values in inner for v in values if isinstance(v, (dict, list))]
        if not level:
            return
    raise _too_deep()


def parse_case(text: str) -> Case:
    """Check the text of a case file. Raises `CaseError`, naming the key."""
    content = parse_toml(text)
    try:
        return Case.model_validate(content)
    except ValidationError as error:
        # A key that is not known explains one that is missing, not the other way round.
        problems = error.errors(include_url=False)
        problems.sort(key=lambda problem: problem["type"] != "extra_forbidden")
        raise CaseError(_in_words(problems[0]) + _others(problems)) from None


def _others(problems: list[Any]) -> str:
    """The other keys with a problem, up to three by name."""
    names = list(dict.fromkeys(_key_of(problem) for problem in problems))[1:]
    if not names:
        return ""
    more = [f"{len(names) - _NAMED} more"] if len(names) > _NAMED else []
    return f" (also wrong: {', '.join(names[:_NAMED] + more)})"


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
    tags = {"exponential", "gaussian", "self-affine", "measured"}
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
    if path[:2] == ["roughness", "crop"]:
        return list(CropTable.model_fields)
    tables: dict[str, type[Table]] = {
        "first": BodyTable, "second": BodyTable, "interface": InterfaceTable, "grid": GridTable,
        "indentation": Series[Length], "load": Series[Force], "impact": ImpactTable,
        "unloading": UnloadingTable,
        "roughness": MeasuredRoughness if "measured" in loc else GeneratedRoughness,
    }  # fmt: skip
    model = tables[path[0]] if path else Case
    return [field.alias or name for name, field in model.model_fields.items()]
