"""The figure of a mixture: COR of every pair against impact velocity."""

from __future__ import annotations

import math
from collections.abc import Sequence

from restitution.laws.law import Law
from restitution.plots.cor import IMPACT_VELOCITY, cor_chart
from restitution.plots.figure import GREY, PALETTE, Figure, Line


def mixture_figure(title: str, laws: Sequence[Law]) -> Figure:
    """Plot the COR: a chart for every pair of materials, with a line for every pair of sizes.

    Lines are labelled with the reduced radius R*. In a chart of more than five lines, at most five
    lines have labels.
    """
    charts = []
    for (first, second), members in families_of(laws).items():
        ordered = sorted(members, key=lambda law: law.radius)
        step = math.ceil(len(ordered) / 5)
        series = [
            Line(
                law.column("velocity"),
                law.column("restitution"),
                "" if number % step else f"R* = {1e6 * law.radius:.3g} µm",
                color=GREY if number % step else PALETTE[number // step],
            )
            for number, law in enumerate(ordered)
        ]
        charts.append(cor_chart(IMPACT_VELOCITY.axis, series, f"{first} on {second}"))
    return Figure(title, charts)


def families_of(laws: Sequence[Law]) -> dict[tuple[str, str], list[Law]]:
    """Group the laws by their two materials; the keys are the names of the materials."""
    found: dict[tuple[str, str], list[Law]] = {}
    for law in laws:
        found.setdefault((law.first.name, law.second.name), []).append(law)
    return found
