"""The form on the page of `restitution app`: the keys of the case file that have a label."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any

from restitution.app.presets import presets
from restitution.case.bodies import FROM_LIBRARY
from restitution.case.case import Case
from restitution.case.materials import Material, materials
from restitution.case.quantities import unit_factors
from restitution.case.rulebook import Input, Rule, rules, tables_in
from restitution.dem.export import CODES
from restitution.display import quantity

Choice = tuple[str, str]  # the value in the case file, and its label in the form

_SECOND: tuple[Choice, ...] = (("", "the same as the first"), ("own", "its own values"))
_GRID: tuple[Choice, ...] = (("", "chosen by the program"), ("own", "its own values"))
# The tables that prescribe depths, as the page offers them.
_DEPTHS = {
    "impact": "impact velocities",
    "indentation": "indentations",
    "load": "loads",
}


@dataclass(frozen=True)
class Field:
    """A field of the form, which edits the key `key` of the case file; see `rulebook.Key`.

    `low` and `high` are the ends of its slider. With `when`, it is shown only while the key
    `when[0]` has one of the values `when[1:]`; "" stands for a missing key.
    """

    key: str
    label: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    logarithmic: bool = True
    whole: bool = False
    choices: tuple[Choice, ...] = ()
    when: tuple[str, ...] = ()
    initial: Any = None
    hint: str = ""
    more: bool = False
    switch: str = ""
    help: str = ""


@dataclass(frozen=True)
class Group:
    """Fields under one heading."""

    title: str
    fields: tuple[Field, ...]
    closed: bool = False


def form(case: type[Case] = Case) -> dict[str, Any]:
    """Return as JSON data the groups of fields, the units, the DEM codes and the materials."""
    return {
        "groups": [asdict(group) for group in _groups(case)],
        "units": unit_factors(),
        "codes": CODES,
        "presets": presets(),
        "library": {key: _library_values(material) for key, material in materials().items()},
    }


def _library_values(material: Material) -> dict[str, str]:
    """The values that `material` supplies to a body, written as in a case file."""
    known = ((key, unit, getattr(material, key)) for key, unit in FROM_LIBRARY.items())
    return {
        key: quantity(one.value, unit) if unit == "Pa" else f"{one.value:g} {unit}".strip()
        for key, unit, one in known
        if one is not None
    }


def _groups(case: type[Case]) -> list[Group]:
    second = Field("second", "Second particle", choices=_SECOND)
    depths = Field("depths", "Depths given as", choices=tuple(_DEPTHS.items()))
    top = tuple(_field(rule, rule.name) for rule in rules(case) if _is_shown(rule))
    grid = [
        replace(field, when=("grid", "own")) if field.key != "grid.refine" else field
        for field in _table(case, "grid")
    ]
    return [
        Group("First particle", _table(case, "first")),
        Group("Second particle", (second, *_table(case, "second", ("second", "own")))),
        Group("Interface", _table(case, "interface")),
        Group("Surface", _table(case, "roughness")),
        Group("Velocities", (depths, *(field for name in _DEPTHS for field in _span(case, name)))),
        Group("Grid", (Field("grid", "Grid", choices=_GRID), *grid), closed=True),
        Group("Many impacts", _table(case, "impacts", ("depths", "impact")), closed=True),
        Group("Unloading and title", (*top, *_table(case, "unloading")), closed=True),
    ]


def _is_shown(rule: Rule) -> bool:
    return rule.key.page is not None and not tables_in(rule.field)


def _table(case: type[Case], name: str, when: tuple[str, ...] = ()) -> tuple[Field, ...]:
    """The fields of the table `name`; tables of several kinds share the field of their kind."""
    tables = [list(rules(table)) for table in tables_in(case.model_fields[name])]
    if len(tables) == 1:
        return tuple(_fields(tables[0], name, when))
    kinds = [next(rule for rule in table if rule.name == "kind") for table in tables]
    choices = [choice for kind in kinds for choice in kind.choices.items()]
    kind = _field(kinds[0], f"{name}.kind")
    fields = [replace(kind, choices=(kind.choices[0], *choices))]
    for rule, table in zip(kinds, tables, strict=True):
        others = [other for other in table if other.name != "kind"]
        fields += _fields(others, name, (f"{name}.kind", *rule.choices))
    return tuple(fields)


def _fields(table: list[Rule], name: str, when: tuple[str, ...]) -> Iterator[Field]:
    for rule in table:
        if _is_shown(rule):
            other, *values = rule.key.only or ("",)
            yield _field(
                rule, f"{name}.{rule.name}", (f"{name}.{other}", *values) if other else when
            )


def _field(rule: Rule, name: str, when: tuple[str, ...] = ()) -> Field:
    page, default = rule.key.page or Input(""), rule.field.default
    low, high = page.slider or (None, None)
    choices = [choice for choice in rule.choices.items() if choice[0] != default]
    return Field(
        name,
        page.label,
        rule.unit.si if rule.unit else "",
        low,
        high,
        page.logarithmic or rule.unit is not None,
        rule.kinds == {int},
        (("", page.empty), *choices) if choices else (),
        when,
        page.initial,
        page.hint,
        page.more,
        page.switch,
        _plain(rule.key.meaning),
    )


def _plain(markdown: str) -> str:
    """The text without the targets of links and the marks of code."""
    text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", markdown)
    return re.sub(r"[`\\]", "", text)


def _span(case: type[Case], name: str) -> Iterator[Field]:
    """The fields of a table that prescribes depths; {} in a label is the label of the table."""
    page = next(rule.key.page for rule in rules(case) if rule.name == name) or Input("")
    ends = iter(page.initial) if isinstance(page.initial, tuple) else iter(())
    low, high = page.slider or (None, None)
    for field in _table(case, name, ("depths", name)):
        if "{}" in field.label:
            label = field.label.format(page.label)
            field = replace(field, label=label, low=low, high=high, initial=next(ends))
        yield field
