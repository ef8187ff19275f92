"""Impacts one after the other: the surfaces keep their plastic displacement and move with it.

Each impact sees a square window of both periodic surfaces, because its contact is small.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import repeat
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from restitution.arguments import typed
from restitution.collision import Collision, collide
from restitution.contact.checks.edge import EdgeReachedError, largest_reach
from restitution.contact.checks.resolution import predicted_radius
from restitution.contact.bodies import Pair
from restitution.contact.contact import Contact
from restitution.contact.path import unloading_path
from restitution.contact.plasticity.cavity import ExpandingCavity
from restitution.contact.plasticity.remembered import AGAIN, RememberedCavity
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.contact.state import State
from restitution.errors import CaseError, DomainError
from restitution.numerics.grid import Grid
from restitution.numerics.read_only import freeze
from restitution.repeated.points import RepeatedImpact
from restitution.surfaces import Surface
from restitution.theory import ThorntonNing

Array = NDArray[np.float64]
Place = Literal["random", "same", "track"]
Shift = tuple[int, int]

# Width of the first window, in radii of the contact of smooth bodies, and the growth of a window
# that turns out too small.
_FIRST_WINDOW, _WIDER = 4.0, 1.3
_ROUND = 8  # windows are multiples of this number of nodes, so that few operators are needed


class _Body:
    """One periodic surface: its heights, and the largest pressure at which a node has yielded."""

    def __init__(self, height: Array, *, remembers: bool) -> None:
        self.height = height.copy()
        self.borne = np.zeros_like(height) if remembers else None

    def window(self, centre: Shift, width: tuple[int, int]) -> tuple[NDArray[np.intp], ...]:
        return np.ix_(
            *(
                (np.arange(w) - w // 2 + c) % n
                for w, c, n in zip(width, centre, self.height.shape, strict=True)
            )
        )


class RunIn:
    """Two bodies that hit each other again and again.

    The roughness of `contact` belongs to the body that yields; of two that yield, to the first.
    `contact` itself stays as it is.

    Args:
        contact: The first impact. Its surface is one period, which repeats without end.
        other: Roughness of the other body (on the grid of `contact`); None if it is smooth.
        place: "random": both bodies are hit at new places; "same": at one place; "track": the
            other body at one place, as a wall, and the rough one at new places.
        seed: Seed of the places.

    Raises:
        CaseError: The contact is a periodic one, or its model of plasticity is `Truncated`.
    """

    @typed
    def __init__(
        self,
        contact: Contact,
        other: Surface | None = None,
        *,
        place: Place = "random",
        seed: int = 0,
    ) -> None:
        if contact.periodic:
            raise CaseError("contact: repeated impacts need a sphere; leave periodic out")
        if not contact.plasticity.bounds_solve:
            raise CaseError(
                f'plasticity: "{contact.plasticity.label}" defines a single impact; use '
                "ConstantBound or ExpandingCavity"
            )
        if place not in get_args(Place):
            raise CaseError(f"place: {place!r} is not one of {', '.join(get_args(Place))}")
        if other is not None and other.grid != contact.grid:
            raise CaseError("other: is on another grid; give a surface on the grid of contact")
        remembers = isinstance(contact.plasticity, ExpandingCavity)
        heights = contact.surface.height, (
            np.zeros(contact.grid.nodes) if other is None else other.height
        )
        self._bodies = [_Body(height, remembers=remembers) for height in heights]
        yields = (True, True) if contact.yields in (None, "both") else (True, False)
        self._yielding = [body for body, soft in zip(self._bodies, yields, strict=True) if soft]
        self._contact, self._place = contact, place
        self._places = np.random.default_rng(seed)
        self._width = 0
        self._count, self._coverage = 0, 0.0
        self._others = [contact.surface.provenance, None if other is None else other.provenance]

    @property
    def count(self) -> int:
        """Number of impacts so far."""
        return self._count

    @property
    def coverage(self) -> float:
        """Area of the contacts of smooth bodies so far, divided by the area of the surface."""
        return self._coverage

    @property
    def surfaces(self) -> tuple[Surface, Surface]:
        """The surfaces of the two bodies now, the rough one first."""
        grid = self._contact.grid
        first, second = (
            Surface(
                freeze(body.height.copy()),
                grid,
                {**(origin or {"source": "smooth"}), "impacts": self._count},
            )
            for body, origin in zip(self._bodies, self._others, strict=True)
        )
        return first, second

    def coverage_of(self, velocity: float) -> float:
        """Coverage of one impact at `velocity` (m/s)."""
        return nominal_area(self._contact, velocity) / math.prod(self._contact.grid.size)

    @typed
    def impacts(self, velocities: float | Iterable[float]) -> Iterator[RepeatedImpact]:
        """Let the bodies collide, and change their surfaces.

        Args:
            velocities: Impact velocities (m/s), or one for impacts without end.

        Yields:
            Each impact.

        Raises:
            DomainError: A contact is larger than the surface.
            NotConvergedError: A solve did not converge.
        """
        each = repeat(velocities) if isinstance(velocities, (int, float)) else velocities
        for velocity in each:
            yield self.hit(float(velocity), *self._next_place())

    def hit(self, velocity: float, first: Shift, second: Shift) -> RepeatedImpact:
        """Let the bodies collide once, and change their surfaces.

        Args:
            velocity: Impact velocity (m/s).
            first: Node of the rough body that is hit.
            second: Node of the other body that is hit.
        """
        state, collision, end = self._collide(velocity, (first, second))
        self._wear((first, second), end)
        self._count += 1
        self._coverage += self.coverage_of(velocity)
        return RepeatedImpact.of(self._count, self._coverage, velocity, state, collision)

    def probe(self, velocity: float, places: int, seed: int) -> list[RepeatedImpact]:
        """Let the bodies collide at random places, each time with the surfaces as they are now.

        Args:
            velocity: Impact velocity (m/s).
            places: Number of impacts.
            seed: Seed of the places.
        """
        random = np.random.default_rng(seed)
        results = []
        for _ in range(places):
            at = self._random_place(random), self._random_place(random)
            state, collision, _ = self._collide(velocity, at)
            results.append(
                RepeatedImpact.of(self._count, self._coverage, velocity, state, collision)
            )
        return results

    def _random_place(self, random: np.random.Generator) -> Shift:
        nx, ny = self._contact.grid.nodes
        return int(random.integers(nx)), int(random.integers(ny))

    def _next_place(self) -> tuple[Shift, Shift]:
        centre = tuple(n // 2 for n in self._contact.grid.nodes)
        first, second = self._random_place(self._places), self._random_place(self._places)
        if self._place == "same":
            return centre, centre
        return first, centre if self._place == "track" else second

    def _collide(
        self, velocity: float, at: tuple[Shift, Shift]
    ) -> tuple[State, Collision, State]:
        """Deepest state, collision, and the state after separation."""
        nodes, spacing = self._contact.grid.nodes, min(self._contact.grid.spacing)
        if not self._width:
            radius = math.sqrt(nominal_area(self._contact, velocity) / math.pi)
            self._width = _rounded(_FIRST_WINDOW * radius / spacing)
        while True:
            contact = self._window(at)
            try:
                state = solve_at_velocity(contact, velocity)
                half = 0.5 * spacing * min(contact.grid.nodes)
                if min(contact.grid.nodes) >= min(nodes) or self._reach(contact, state) < half:
                    break
            except EdgeReachedError as error:
                if min(contact.grid.nodes) >= min(nodes):
                    raise DomainError(
                        f"the contact at {velocity:.4g} m/s is larger than the surface; use a "
                        "larger surface or a lower velocity"
                    ) from error
            self._width = _rounded(_WIDER * self._width)
        if not contact.adhesive:
            return state, collide(state), state
        path = list(unloading_path(state))
        return state, collide(state, path), path[-1]

    def _reach(self, contact: Contact, state: State) -> float:
        return largest_reach(contact, state.indentation)

    def _window(self, at: tuple[Shift, Shift]) -> Contact:
        grid = self._contact.grid
        width = min(self._width, grid.nodes[0]), min(self._width, grid.nodes[1])
        parts = [body.window(centre, width) for body, centre in zip(self._bodies, at, strict=True)]
        height = sum(
            body.height[part] for body, part in zip(self._bodies, parts, strict=True)
        )
        plasticity = self._contact.plasticity
        if isinstance(plasticity, ExpandingCavity):
            borne = np.minimum.reduce(
                [
                    body.borne[part]
                    for body, part in zip(self._bodies, parts, strict=True)
                    if body in self._yielding
                ]
            )
            plasticity = RememberedCavity(
                plasticity.yield_strength, plasticity.tangent_modulus, borne
            )
        window = Surface(freeze(height), Grid(width, grid.spacing), {"source": "repeated"})
        return replace(self._contact, surface=window, plasticity=plasticity)

    def _wear(self, at: tuple[Shift, Shift], end: State) -> None:
        """Lower the surfaces by the plastic displacement; of two bodies, the softer one yields."""
        given = end.plastic_displacement
        if not given.any():
            return
        width = end.contact.grid.nodes
        parts = {
            id(body): body.window(centre, width)
            for body, centre in zip(self._bodies, at, strict=True)
        }
        bound = np.broadcast_to(end.bound, width)
        soft = [
            np.ones(width, dtype=bool)
            if body.borne is None
            else AGAIN * body.borne[parts[id(body)]] <= bound
            for body in self._yielding
        ]
        shares = np.sum(soft, axis=0)
        for body, softer in zip(self._yielding, soft, strict=True):
            part = parts[id(body)]
            body.height[part] -= np.where(softer, given / shares, 0.0)
            if body.borne is not None:
                old = body.borne[part]
                higher = (given > 0) & (bound > AGAIN * old)
                body.borne[part] = np.where(higher, bound, old)


def nominal_area(contact: Contact, velocity: float) -> float:
    """Area (m²) of the contact of smooth bodies at the impact velocity (m/s).

    Source: C. Thornton, Z. Ning, Powder Technol. 99 (1998) 154–162, for the indentation.
    """
    pair: Pair = contact.pair
    if pair.mass is None:
        raise CaseError("density: is missing; an impact velocity needs the density of both bodies")
    p_y = min(contact.hardness, pair.contact_modulus)
    smooth = ThorntonNing(pair.radius, pair.contact_modulus, p_y)
    depth = float(smooth.indentation_from_velocity(velocity, pair.mass))
    return math.pi * predicted_radius(pair, depth, contact.hardness) ** 2


def _rounded(width: float) -> int:
    return _ROUND * math.ceil(width / _ROUND)
