"""Curves beside that of a run: on less accurate unloading paths, at its depths or its works."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial

from restitution.collision import UnloadingMethod
from restitution.contact.contact import Contact
from restitution.contact.interface import interface_of
from restitution.contact.loading import solve
from restitution.contact.models import RESTITUTION_ERROR
from restitution.contact.prescribed.velocity import path_around_work
from restitution.contact.state import State
from restitution.curve.follow import Impact, Load, Unloading, follow
from restitution.curve.work_curve import WorkCurve
from restitution.errors import DomainError, RestitutionError

# Allowed errors of COR due to the steps of adhesive unloading, and of paths that follow them also
# in loading. For yielding silica (benchmarks/cohesive.py), COR then differs by at most 3e-3 from
# that of 0.0005.
_TOLERANCE, _OF_PATHS = 0.005, 0.015
_RESIDUAL = 3e-4  # of solves under pressure on a loading path

# A companion curve has two more depths than the run: the smallest depth times the first factor, and
# the largest depth times the second factor. They are needed because other surfaces reach the same
# loading work at other depths.
_SHALLOWER, _DEEPER = 0.5, 1.3


def curve_of(
    contact: Contact,
    depths: Sequence[float],
    method: UnloadingMethod,
    tolerance: float = _TOLERANCE,
) -> WorkCurve:
    """Compute the curve of `contact` at `depths` (m) and at one more depth beyond each end.

    `tolerance` is the allowed error of COR due to the steps of adhesive unloading. A depth that
    cannot be solved is left out. The curve ends where the contact reaches the edge of the grid.
    """
    loads = loads_at([contact] * len(depths), depths)
    return work_curve(impacts_of(loads, method, tolerance))


def loads_at(contacts: Sequence[Contact], depths: Sequence[float]) -> list[Load]:
    return [
        Load(contact, partial(_solve, contact, depth), depth)
        for contact, depth in zip(
            (contacts[0], *contacts, contacts[-1]),
            (_SHALLOWER * depths[0], *depths, _DEEPER * depths[-1]),
            strict=True,
        )
    ]


def impacts_of(
    loads: Sequence[Load], method: UnloadingMethod, tolerance: float = _TOLERANCE
) -> list[Impact]:
    return list(follow(loads, Unloading(method, tolerance=tolerance), _failed))


def work_curve(impacts: Iterable[Impact]) -> WorkCurve:
    return WorkCurve.of(impact.collision for impact in impacts)


def _failed(error: RestitutionError) -> bool:
    return not isinstance(error, DomainError)  # deeper contacts reach the edge of the grid, too


def _solve(contact: Contact, depth: float, start: State | None) -> State:
    # Only a loading path is long enough to be worth continuing.
    return solve(contact, depth, start=start if interface_of(contact).follows_path else None)


def impacts_around(
    contact: Contact, works: Sequence[float], method: UnloadingMethod
) -> list[Impact]:
    """Impacts on a path: one below the first of `works` (J), one at or beyond each of the others.

    The first is beyond, too, if the work jumps there from a value that is not positive.
    """
    return impacts_of(_loads_around(contact, works), method, _OF_PATHS) if works else []


def _loads_around(contact: Contact, works: Sequence[float]) -> list[Load]:
    first, *others = works
    ends = [(first, 0), *((work, 1) for work in others or works)]
    paths: dict[float, tuple[State, State]] = {}

    def to(work: float, side: int, start: State | None) -> State:
        if work not in paths:
            scale = _OF_PATHS / RESTITUTION_ERROR * work
            path = path_around_work(contact, work, start=start, scale=scale, residual=_RESIDUAL)
            assert path is not None
            paths[work] = path
        before, after = paths[work]
        return after if side or before.loading_work <= 0 else before

    return [Load(contact, partial(to, work, side), work) for work, side in ends]
