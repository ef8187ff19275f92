"""Previews of a curve: the same case with fewer depths and larger cells, solved less accurately."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from statistics import median_low
from typing import Any

import numpy as np

from restitution.case.case import Case
from restitution.contact.checks.resolution import NODES_PER_RADIUS, predicted_radius
from restitution.contact.contact import Contact
from restitution.contact.interface import interface_of
from restitution.curve.follow import Impact, Load, Unloading
from restitution.display import quantity
from restitution.runs.companions import coarser_contact
from restitution.runs.depths import CaseUnloading, first_touch, load_to
from restitution.runs.error_budget import usual_grid_error
from restitution.surfaces import rms_slope
from restitution.theory import JKR

_FEWEST_NODES, _FEWEST_DEPTHS = 32, 3  # of the coarsest level, along an edge of the grid
_FEWEST_PER_RADIUS = 4  # nodes in the radius of a contact with the fewest depths
_PER_ATTRACTION = 2.0  # how much larger a contact counts that attraction alone makes
_UNLOADING, _LOADING = 0.05, 0.02  # errors of COR that previews accept from the steps of each

# Time (s) for which the page waits rather than draw a coarser level first: a curve
# should follow a slider within 0.3 s, and takes 0.1 s to be drawn.
_SOON = 0.15
# A level is left out if a finer one takes at most this many times as long as the last one drawn.
_WORTH_WAITING = 8.0
_SLOWER = 5.0  # time of a level divided by that of the level before, until both are known
_MOST_KINDS = 64  # number of kinds of curves whose times are kept


@dataclass(frozen=True)
class Level:
    """Depths of a case (m, N, m/s or Pa), and the factors by which the cells are larger there."""

    depths: tuple[float, ...]
    factors: tuple[int, ...]


class Ladder:
    """The levels of the curve of `case`, coarsest first, and last that of all depths and nodes.

    Each has half as many depths as the next, and cells up to twice as large.
    """

    def __init__(self, case: Case, contact: Contact) -> None:
        if contact.adhesion is not None:
            # The relative error of COR is half that of the work.
            rough = contact.adhesion.with_work_tolerance(2 * _LOADING)
            contact = replace(contact, adhesion=rough)
        # The contact on cells that are larger by the factors 1, 2, 4, …
        self.case, self._contacts = case, [contact]
        self._slopes: dict[tuple[float, float], float] = {}  # rms slopes, by the size of the cells
        deep = {depth: case.indentation_at(depth) for depth in case.depths()}
        cell, pair, limit = max(contact.grid.spacing), contact.pair, contact.hardness
        # The nodes in the predicted radius of the contact at each depth. Adhesion widens shallow
        # contacts to about the radius at which they detach.
        least = 0.0
        if contact.adhesion is not None and contact.adhesion.attracts:
            smooth = JKR(pair.radius, pair.contact_modulus, contact.adhesion.work_of_adhesion)
            least = _PER_ATTRACTION * float(smooth.pull_off_radius)
        self._nodes = {
            depth: max(predicted_radius(pair, deep[depth], limit), least) / cell for depth in deep
        }
        count, factor = len(case.depths()), 1
        levels = [self._level(count, factor)]
        while True:
            if min(contact.grid.nodes) >= 2 * factor * _FEWEST_NODES:
                factor *= 2
            count = max(math.ceil(count / 2), min(_FEWEST_DEPTHS, count))
            level = self._level(count, factor)
            if level in levels:
                break
            levels.append(level)
        self.levels = tuple(reversed(levels))

    @property
    def kind(self) -> Any:
        """What mostly determines the time of a level."""
        case, contact = self.case, self._contacts[0]
        models = type(contact.plasticity), type(contact.adhesion)
        return *models, contact.grid, case.prescribed, len(case.depths()), case.unloading

    @property
    def unloading(self) -> Unloading:
        """How a preview is unloaded."""
        given = CaseUnloading.of_case(self.case)
        return replace(given, tolerance=max(given.tolerance, _UNLOADING))

    def words(self, level: Level) -> str:
        """What the preview `level` is."""
        cell, factors = max(self._contacts[0].grid.spacing), level.factors
        ends = [quantity(factor * cell, "m") for factor in sorted({min(factors), max(factors)})]
        count = len(self.case.depths())
        return f"{len(level.depths)} of {count} depths, cells of {' to '.join(ends)}"

    def loads(self, level: Level) -> Iterator[Load]:
        """The loads of the preview `level`, from the shallowest to the deepest."""
        own = self._contacts[0]
        touches = {1: first_touch(own.surface, own.pair.radius)}
        for depth, factor in zip(level.depths, level.factors, strict=True):
            contact = self._coarser(factor)
            if factor not in touches:
                touches[factor] = first_touch(contact.surface, own.pair.radius)
            touch = touches[factor] - touches[1]
            to = depth - touch if self.case.indentation else depth
            if to > 0:
                yield Load(contact, partial(load_to, self.case, contact, to), depth, 1, touch)

    def usual_error(self, impact: Impact) -> float:
        """Error of COR to expect of a preview.

        It is that of the steps, that which is usual with as many nodes in the median patch, and
        the share of the loss 1 − e that corresponds to the slope which larger cells leave out.
        """
        point, own = impact.point, self._slope(self._contacts[0])
        left = self._slope(impact.load.contact) / own if own else 1.0
        omitted = max(0.0, 1 - left) * (1 - point.restitution)
        return math.hypot(point.restitution_error, usual_grid_error(point), omitted)

    def _level(self, count: int, largest: int) -> Level:
        depths = list(self._nodes)
        numbers = np.unique(np.linspace(0, len(depths) - 1, count).round().astype(int))
        chosen = tuple(depths[number] for number in numbers)
        left = NODES_PER_RADIUS if count > _FEWEST_DEPTHS else _FEWEST_PER_RADIUS
        ratios = [max(1.0, self._nodes[depth] / left) for depth in chosen]
        if interface_of(self._contacts[0]).follows_path:  # on other cells a path begins again
            ratios = [median_low(ratios)] * len(ratios)
        return Level(chosen, tuple(min(largest, 2 ** int(math.log2(ratio))) for ratio in ratios))

    def _slope(self, contact: Contact) -> float:
        cells = contact.grid.spacing
        if cells not in self._slopes:
            self._slopes[cells] = rms_slope(contact.surface)
        return self._slopes[cells]

    def _coarser(self, factor: int) -> Contact:
        """The contact on cells `factor` times as large, a power of two."""
        while 2 ** (len(self._contacts) - 1) < factor:
            self._contacts.append(coarser_contact(self._contacts[-1]))
        return self._contacts[factor.bit_length() - 1]


class Pace:
    """Which level of a curve to compute next, from the times of the levels of similar curves."""

    def __init__(self) -> None:
        self._seconds: dict[Any, dict[Level, float]] = {}

    def note(self, ladder: Ladder, number: int, seconds: float) -> None:
        """Store the time (s) of level `number`; those of other levels change by the same factor."""
        level, times = ladder.levels[number], self._seconds.pop(ladder.kind, {})
        change = seconds / times.get(level, seconds)
        others = {other: change * time for other, time in times.items()}
        self._seconds[ladder.kind] = {**others, level: seconds}
        if len(self._seconds) > _MOST_KINDS:
            del self._seconds[next(iter(self._seconds))]

    def first(self, ladder: Ladder, spent: float) -> int:
        """The number of the level to begin with: the finest that is expected soon, or 0.

        `spent` is the time (s) since the page asked for the curve.
        """
        return _finest(self._expected(ladder), 0, _SOON - spent)

    def next(self, ladder: Ladder, done: int, spent: float) -> tuple[int, bool]:
        """The number of the level after `done`, and whether to draw `done` before.

        `spent` is that of `first`.
        """
        expected = self._expected(ladder)
        if expected[done + 1] <= _SOON - spent:
            return _finest(expected, done + 1, _SOON - spent), False
        return _finest(expected, done + 1, _WORTH_WAITING * expected[done]), True

    def _expected(self, ladder: Ladder) -> list[float]:
        """Time (s) of each level; infinite if neither it nor a coarser one is known."""
        times, expected = self._seconds.get(ladder.kind, {}), list[float]()
        for level in ladder.levels:
            guess = _SLOWER * expected[-1] if expected else math.inf
            expected.append(times.get(level, guess))
        return expected


def _finest(expected: Sequence[float], least: int, limit: float) -> int:
    within = (number for number in range(least, len(expected)) if expected[number] <= limit)
    return max(within, default=least)
