"""Rows of tables of repeated impacts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from restitution.collision import Collision
from restitution.contact.state import State
from restitution.curve.columns import Record, array, column, magnitude
from restitution.numerics.intervals import half_interval

FEWEST = 40  # smallest number of impacts for a statement on the steady state
STEADY = 0.02  # largest change of COR per coverage in a steady sequence
_BLOCKS = 8


@dataclass(frozen=True, kw_only=True)
class RepeatedImpact(Record):
    """One impact of a sequence, in SI units; its fields are the columns of `impacts.csv`."""

    number: float = magnitude("impact", "1", "number of the impact, from 1")
    coverage: float = magnitude(
        "coverage", "1", "area of the contacts of smooth bodies so far, over that of the surface"
    )
    velocity: float = magnitude("impact_velocity_m_per_s", "m s-1", "impact velocity")
    restitution: float = magnitude("restitution", "1", "coefficient of restitution", high=1.0)
    indentation: float = column("max_indentation_m", "m", "maximum indentation")
    force: float = column("force_N", "N", "normal force at maximum indentation")
    contact_area: float = magnitude("contact_area_m2", "m2", "real contact area")
    loading_work: float = column("loading_work_J", "J", "work of loading")
    unloading_work: float = column("unloading_work_J", "J", "work returned until separation")
    plastic_work: float = magnitude("plastic_work_J", "J", "work dissipated by yielding")
    adhesive_loss: float = column("adhesive_loss_J", "J", "energy dissipated by adhesion")
    plastic_volume: float = column(
        "plastic_volume_m3", "m3", "volume by which yielding has lowered the surfaces"
    )
    pull_off_force: float = column("pull_off_force_N", "N", "largest tension during unloading")
    restitution_error: float = magnitude("restitution_error", "1", "error of COR due to the solver")

    @classmethod
    def of(
        cls, number: int, coverage: float, velocity: float, state: State, collision: Collision
    ) -> Self:
        return cls(
            number=float(number),
            coverage=coverage,
            velocity=velocity,
            restitution=collision.restitution,
            indentation=state.indentation,
            force=state.force,
            contact_area=state.contact_area,
            loading_work=collision.loading_work,
            unloading_work=collision.unloading_work,
            plastic_work=state.plastic_work,
            adhesive_loss=collision.adhesive_loss,
            plastic_volume=state.plastic_volume,
            pull_off_force=collision.pull_off_force,
            restitution_error=collision.restitution_error,
        )


@dataclass(frozen=True, kw_only=True)
class RunInPoint(Record):
    """COR at one velocity and one coverage, over many places; a row of `coverage.csv`."""

    velocity: float = magnitude("impact_velocity_m_per_s", "m s-1", "impact velocity")
    coverage: float = magnitude(
        "coverage", "1", "area of the contacts of smooth bodies so far, over that of the surface"
    )
    impacts: float = magnitude("impacts", "1", "number of impacts so far")
    places: float = magnitude("places", "1", "number of places at which COR was measured")
    restitution: float = magnitude(
        "restitution", "1", "mean coefficient of restitution over the places", high=1.0
    )
    restitution_std: float = magnitude(
        "restitution_std", "1", "standard deviation of restitution over the places"
    )
    restitution_5: float = magnitude("restitution_5", "1", "5 % quantile of restitution", high=1.0)
    restitution_25: float = magnitude(
        "restitution_25", "1", "25 % quantile of restitution", high=1.0
    )
    restitution_50: float = magnitude("restitution_50", "1", "median of restitution", high=1.0)
    restitution_75: float = magnitude(
        "restitution_75", "1", "75 % quantile of restitution", high=1.0
    )
    restitution_95: float = magnitude(
        "restitution_95", "1", "95 % quantile of restitution", high=1.0
    )
    sticking_share: float = magnitude(
        "sticking_share", "1", "share of the places at which the bodies stick", high=1.0
    )
    indentation: float = column("max_indentation_m", "m", "mean maximum indentation")
    force: float = column("force_N", "N", "mean normal force at maximum indentation")
    contact_area: float = magnitude("contact_area_m2", "m2", "mean real contact area")
    loading_work: float = magnitude("loading_work_J", "J", "mean work of loading")
    pull_off_force: float = column("pull_off_force_N", "N", "mean pull-off force")
    places_error: float = magnitude(
        "places_error", "1", "half of the 95 % interval of the mean over the places"
    )
    solver_error: float = magnitude("solver_error", "1", "mean error of COR due to the solver")
    discretisation_error: float = magnitude(
        "discretisation_error", "1", "error of the mean due to the grid", optional=True
    )
    surface_scatter: float = magnitude(
        "surface_scatter",
        "1",
        "error of the mean due to scatter between surfaces and sequences of places",
        optional=True,
    )
    total_error: float = magnitude(
        "total_error", "1", "root sum of squares of the errors above", optional=True
    )

    @classmethod
    def of(cls, impacts: Sequence[RepeatedImpact]) -> Self:
        """Combine impacts at one velocity, at several places of the same surfaces."""
        e = array(impacts, "restitution")
        one, n = impacts[0], len(impacts)
        deviation = float(e.std(ddof=1))
        quantiles = {
            f"restitution_{q}": float(np.quantile(e, q / 100)) for q in (5, 25, 50, 75, 95)
        }
        means = ("indentation", "force", "contact_area", "loading_work", "pull_off_force")
        return cls(
            velocity=one.velocity,
            coverage=one.coverage,
            impacts=one.number,
            places=float(n),
            restitution=float(e.mean()),
            restitution_std=deviation,
            **quantiles,
            sticking_share=float(np.mean(e == 0)),
            **{name: float(array(impacts, name).mean()) for name in means},
            places_error=half_interval(n) * deviation,
            solver_error=float(array(impacts, "restitution_error").mean()),
        )


@dataclass(frozen=True)
class SteadyState:
    """Whether COR of a sequence of impacts has become steady, and its value.

    `restitution` and `error` (95 %) are those of the last half of the sequence, and `trend` is the
    slope of COR against coverage in it, with its error. A sequence is `steady` if the trend is
    surely smaller than `STEADY`.
    """

    velocity: float
    impacts: int
    coverage: float
    restitution: float
    error: float
    trend: float
    trend_error: float
    steady: bool

    @classmethod
    def of(cls, impacts: Sequence[RepeatedImpact]) -> SteadyState | None:
        """None for fewer than `FEWEST` impacts."""
        if len(impacts) < FEWEST:
            return None
        last = impacts[len(impacts) // 2 :]
        e, coverage = array(last, "restitution"), array(last, "coverage")
        # Impacts that follow each other see parts of one surface, so blocks of them are compared.
        blocks, at = (
            np.array([part.mean() for part in np.array_split(values, _BLOCKS)])
            for values in (e, coverage)
        )
        away = at - at.mean()
        trend = float(away @ blocks / (away @ away))
        rest = blocks - blocks.mean() - trend * away
        # Two parameters are fitted, so that two blocks count less.
        slope_error = float(np.sqrt(rest @ rest / (_BLOCKS - 2) / (away @ away)))
        trend_error = half_interval(_BLOCKS - 1) * math.sqrt(_BLOCKS - 1) * slope_error
        return cls(
            velocity=impacts[-1].velocity,
            impacts=len(impacts),
            coverage=impacts[-1].coverage,
            restitution=float(e.mean()),
            error=half_interval(_BLOCKS) * float(blocks.std(ddof=1)),
            trend=trend,
            trend_error=trend_error,
            steady=abs(trend) + trend_error <= STEADY,
        )
