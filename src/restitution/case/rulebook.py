"""What the schema says of each key of the case file, for the page's form and the documentation.

The `key` of a field and its type are the only place of these rules.
"""

from __future__ import annotations

import types
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel, Field
from pydantic.fields import FieldInfo

from restitution.case.quantities import Unit


@dataclass(frozen=True)
class Input:
    """The field of a key on the page of `restitution app`.

    Attributes:
        label: Name of the field.
        hint: Text below the field.
        slider: Ends of the slider, in the SI unit of the key.
        logarithmic: Whether the slider of a number without unit is logarithmic, as all others are.
        initial: Value with which the field first appears; of a table, the first and last depth.
        more: Whether the field is in the section "More".
        empty: Choice that leaves the key out.
        choices: Values of the key and their labels, where the schema does not list them.
        switch: Label of a switch that sets the key to `initial` or leaves it out.
    """

    label: str
    hint: str = ""
    slider: tuple[float, float] | None = None
    logarithmic: bool = False
    initial: str | float | tuple[str, str] | None = None
    more: bool = False
    empty: str = ""
    choices: Callable[[], Mapping[str, str]] | None = None
    switch: str = ""


@dataclass(frozen=True)
class Key:
    """What people read about a key.

    Attributes:
        meaning: Text for the documentation, in Markdown.
        default: Default in words, where the schema does not show it.
        only: Another key of the table, and the values with which it allows this key; "" if the
            other key is left out.
        otherwise: Error for other values; `{value}` is the value of this key. Without this text,
            whoever uses the value refuses it.
        page: Its field on the page, which has no other keys.
    """

    meaning: str = ""
    default: str = ""
    only: tuple[str, ...] = ()
    otherwise: str = ""
    page: Input | None = None


def key(value: Any, meaning: str | Key = "", **rule: Any) -> Any:
    """A field of a table with the default `value` (`...` if it is required) and its `Key`."""
    extra: Any = {"key": meaning if isinstance(meaning, Key) else Key(meaning, **rule)}
    return Field(value, json_schema_extra=extra)


@dataclass(frozen=True)
class Rule:
    """A key of a table, with all that the schema says of it."""

    name: str  # as in the file
    attribute: str
    key: Key
    field: FieldInfo

    @property
    def unit(self) -> Unit | None:
        """Unit and quantity of the values; None for other values."""
        return next((part for part in _parts(self.field) if isinstance(part, Unit)), None)

    @property
    def kinds(self) -> set[Any]:
        """Types that a value in the file may have."""
        return {part for part in _parts(self.field) if isinstance(part, type)}

    @property
    def choices(self) -> dict[str, str]:
        """Values and their labels, if the key has one of a few."""
        if self.key.page and self.key.page.choices:
            return dict(self.key.page.choices())
        return {} if self.kinds or self.unit else {word: word for word in self.words}

    @property
    def words(self) -> tuple[str, ...]:
        """Words that the key accepts."""
        return tuple(
            word
            for part in _parts(self.field)
            if get_origin(part) is Literal
            for word in get_args(part)
        )

    @property
    def limits(self) -> list[Ge | Gt | Le | Lt]:
        """Limits of a number."""
        return [part for part in _parts(self.field) if isinstance(part, Ge | Gt | Le | Lt)]


def rules(table: type[BaseModel]) -> Iterator[Rule]:
    """The rules of all keys of `table`."""
    for name, field in table.model_fields.items():
        extra: Any = field.json_schema_extra or {"key": Key()}
        yield Rule(field.alias or name, name, extra["key"], field)


def tables_in(field: FieldInfo) -> list[type[BaseModel]]:
    """The classes of the tables that `field` accepts."""
    return [
        part for part in _parts(field) if isinstance(part, type) and issubclass(part, BaseModel)
    ]


def _parts(hint: Any) -> Iterator[Any]:
    """The metadata, types and literals in an annotation."""
    if isinstance(hint, FieldInfo):
        yield from hint.metadata
        yield from () if hint.annotation is None else _parts(hint.annotation)
    elif get_origin(hint) is Annotated:
        inner, *metadata = get_args(hint)
        for part in metadata:
            yield from part.metadata if isinstance(part, FieldInfo) else (part,)
        yield from _parts(inner)
    elif get_origin(hint) in (Union, types.UnionType, tuple, list):
        for part in get_args(hint):
            yield from () if part in (None, type(None), ...) else _parts(part)
    elif not isinstance(hint, TypeVar):
        yield hint
