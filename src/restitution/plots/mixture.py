"""The figure of a mixture: COR of every pair against impact velocity."""

from __future__ import annotations

from collections.abc import Sequence

from restitution.laws.law import Law
from restitution.plots.cor import cor_axis
from restitution.plots.figure import GREY, PALETTE, Axis, Chart, Figure, Line, Series


def mixture_figure(title: str, laws: Sequence[Law]) -> Figure:
    """Plot the COR of all pairs, with a chart for every pair of materials.

    Lines are labelled with R*. If a chart has more than five pairs, about five lines have labels.
    """
    charts = []
    for (first, second), members in families_of(laws).items():
        ordered = sorted(members, key=lambda law: law.radius)
        shown = ordered[:: max(1, -(-len(ordered) // 5))]
        series: list[Series] = []
        for law in ordered:
            number = shown.index(law) if law in shown else None
            series.append(
                Line(
                    law.column("velocity"),
                    law.column("restitution"),
                    "" if number is None else f"R* = {1e6 * law.radius:.3g} µm",
                    color=GREY if number is None else PALETTE[number],
                )
            )
        heading = f"{first} on {second}"
        charts.append(
            Chart(Axis("impact velocity", "m/s", "log"), cor_axis(series), series, heading)
        )
    return Figure(title, charts)


def families_of(laws: Sequence[Law]) -> dict[tuple[str, str], list[Law]]:
    """Group the laws by their two materials; the keys are the names of the materials."""
    found: dict[tuple[str, str], list[Law]] = {}
    for law in laws:
        found.setdefault((law.first.name, law.second.name), []).append(law)
    return found
