"""The figure of a fit: measured restitution, and the fitted curve with its 95 % band."""

from __future__ import annotations

from restitution.fit.fit import Fit
from restitution.plots.cor import IMPACT_VELOCITY, cor_chart
from restitution.plots.figure import BLUE, ORANGE, Band, Figure, Line, Points, Series


def fit_figure(found: Fit) -> Figure:
    """Plot measured COR with its standard deviations, and the fitted COR with its 95 % band."""
    curve, measured = found.curve, found.measured
    series: list[Series] = []
    if curve.velocity.size > 1:
        low, high = curve.restitution - curve.half_band, curve.restitution + curve.half_band
        band = low.clip(0.0, 1.0), high.clip(0.0, 1.0)
        series.append(Band(curve.velocity, *band, "95 % interval of the fit", color=BLUE))
    series.append(Line(curve.velocity, curve.restitution, "fitted", color=BLUE))
    series.append(
        Points(
            measured.velocity,
            measured.restitution,
            "measured",
            color=ORANGE,
            error=measured.deviation,
            error_label="" if measured.deviation is None else "standard deviation",
            open=~found.resolved,
            open_label="measured, contact not resolved",
        )
    )
    values = ", ".join(
        f"{each.key} {each.text(factor)}"
        for each, factor in zip(found.parameters, found.factors, strict=True)
    )
    return Figure(values, [cor_chart(IMPACT_VELOCITY.axis, series)])
