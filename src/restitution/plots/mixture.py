"""The figure of a mixture: COR of every pair against impact velocity."""

from __future__ import annotations

import math
from collections.abc import Sequence

from restitution.display import quantity
from restitution.laws.law import Law
from restitution.plots.cor import IMPACT_VELOCITY, cor_chart
from restitution.plots.figure import DASHED, GREY, PALETTE, SOLID, Figure, Line

_MOST_ENTRIES = 2 * len(PALETTE)  # each colour with two kinds of lines


def mixture_figure(title: str, laws: Sequence[Law]) -> Figure:
    """Plot the COR: a chart for every pair of materials, with a line for every pair of sizes.

    Every line has an entry in the legend, its reduced radius R*. In a chart of more than
    `_MOST_ENTRIES` lines, grey lines between the labelled ones share one entry.
    """
    families = families_of(laws)
    names = [f"{first} on {second}" if len(families) > 1 else "" for first, second in families]
    charts = [
        cor_chart(IMPACT_VELOCITY.axis, _lines(members), name)
        for name, members in zip(names, families.values(), strict=True)
    ]
    return Figure(title, charts)


def _lines(laws: Sequence[Law]) -> list[Line]:
    ordered = sorted(laws, key=lambda law: law.radius)
    step = math.ceil(len(ordered) / _MOST_ENTRIES)
    return [
        _line(law, number // step) if number % step == 0 else _line(law, None)
        for number, law in enumerate(ordered)
    ]


def _line(law: Law, place: int | None) -> Line:
    """A line with the `place`th style and its own entry in the legend; grey if `place` is None."""
    name = f"R* = {quantity(law.radius, 'm')}"
    V, e = law.column("velocity"), law.column("restitution")
    if place is None:
        return Line(V, e, "R* between these", name=name, color=GREY)
    dashes, color = divmod(place, len(PALETTE))
    return Line(V, e, name, name=name, color=PALETTE[color], dash=(SOLID, DASHED)[dashes])


def families_of(laws: Sequence[Law]) -> dict[tuple[str, str], list[Law]]:
    """Group the laws by their two materials; the keys are the names of the materials."""
    found: dict[tuple[str, str], list[Law]] = {}
    for law in laws:
        found.setdefault((law.first.name, law.second.name), []).append(law)
    return found
