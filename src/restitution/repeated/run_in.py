"""Impacts one after the other: the surfaces keep their plastic displacement and move with it.

Each impact sees a window of both periodic surfaces that contains its whole contact.
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
from restitution.contact.bodies import Pair
from restitution.contact.checks.edge import EdgeReachedError, largest_reach
from restitution.contact.checks.resolution import predicted_radius
from restitution.contact.contact import Contact
from restitution.contact.models import COMPANION
from restitution.contact.patch.law import law_of_patches
from restitution.contact.path import unloading_path
from restitution.contact.plasticity.remembered import remembering
from restitution.contact.prescribed.velocity import mass_in_impact, solve_at_velocity
from restitution.contact.state import State
from restitution.errors import CaseError, DomainError
from restitution.numerics.grid import Grid
from restitution.numerics.read_only import freeze
from restitution.repeated.points import RepeatedImpact
from restitution.surfaces import Surface
from restitution.theory import Hertz, ThorntonNing

Array = NDArray[np.float64]
Nodes = tuple[NDArray[np.intp], ...]
Place = Literal["random", "same", "track"]
Shift = tuple[int, int]

# Width of the first window, in radii of the contact of smooth bodies, and the growth of a window
# that is too small.
_FIRST_WINDOW, _WIDER = 4.0, 1.3
_ATTRACTED = 5.0  # gap beyond which attraction is neglected, in its lengths
_ROUND = 8  # windows are multiples of this number of nodes, so that few operators are needed
# An impact is deeper than if full pressure carried all overlap, by a share of Hertz's depth that
# hardly changes between places; that of the first impact. The first guess is shallower, because the
# loading work of a greater depth would be integrated in vain.
_FIRST_DEEPER, _SHALLOWER, _LEAST = 0.2, 0.96, 0.3
# Steps across the edges of a periodic surface are at most this multiple of those inside (rms).
_MOST_STEP = 2.0


class _Worn:
    """One body: its periodic heights, and the bound at which each node has yielded."""

    def __init__(self, height: Array, *, yields: bool, remembers: bool) -> None:
        self.height, self.yields = height.copy(), yields
        self.borne = np.zeros_like(height)
        self.remembers = remembers

    def nodes(self, centre: Shift, width: tuple[int, int]) -> Nodes:
        """Indices of a window around the node `centre`."""
        return np.ix_(
            *(
                (np.arange(w) - w // 2 + c) % n
                for w, c, n in zip(width, centre, self.height.shape, strict=True)
            )
        )


class RunIn:
    """Two bodies that hit each other again and again; which of them yields, `contact` says.

    Args:
        contact: Contact of the new bodies. Its surface is that of the first body, one period that
            repeats without end.
        other: Surface of the second body, on the same grid; None if it is smooth.
        place: "random": both bodies are hit at new places; "same": both at one place; "track": the
            wall of the pair at one place, and the sphere at new ones.
        seed: Seed of the places.

    Raises:
        CaseError: The contact is periodic, `Truncated` or has waves below the grid, a surface does
            not repeat, or "track" is given without a wall.
    """

    @typed
    def __init__(
        self,
        contact: Contact,
        other: Surface | None = None,
        *,
        place: str = "random",
        seed: int = 0,
    ) -> None:
        _check(contact, other, place)
        remembers = contact.plasticity.grows
        smooth = np.zeros(contact.grid.nodes)
        self._origins = [
            {"source": "smooth"} if surface is None else surface.provenance
            for surface in (contact.surface, other)
        ]
        self._bodies = tuple(
            _Worn(
                height,
                yields=contact.yields in (None, "both", name),
                remembers=remembers,
            )
            for name, height in (
                ("first", contact.surface.height),
                ("second", smooth if other is None else other.height),
            )
        )
        self._contact, self._place = contact, place
        self._places = np.random.default_rng(seed)
        adhesion = contact.adhesion
        self._range = 0.0  # how far the bodies attract each other (m)
        if adhesion is not None:
            length = max(adhesion.length(contact.pair), adhesion.equilibrium_separation)
            self._range = _ATTRACTED * length
        self._width, self._count, self._coverage = 0, 0, 0.0
        self._deeper = _FIRST_DEEPER  # see `_depths`

    @property
    def count(self) -> int:
        """Number of impacts so far."""
        return self._count

    @property
    def coverage(self) -> float:
        """Contact area of smooth bodies so far over the area of the surface (dimensionless)."""
        return self._coverage

    @property
    def surfaces(self) -> tuple[Surface, Surface]:
        """The surfaces of the first and the second body now."""
        first, second = (
            Surface(
                freeze(body.height.copy()),
                self._contact.grid,
                {**origin, "impacts": self._count, "coverage": self._coverage},
            )
            for body, origin in zip(self._bodies, self._origins, strict=True)
        )
        return first, second

    @typed
    def coverage_of(self, velocity: float) -> float:
        """Coverage of one impact.

        Args:
            velocity: Impact velocity (m/s).

        Returns:
            Contact area of smooth bodies over the area of the surface (dimensionless).

        Raises:
            CaseError: The velocity is not positive, or a body has no density.
        """
        contact = self._contact
        hardness = contact.plasticity.of_smooth(contact.pair).hardness
        area = nominal_area(contact.pair, hardness, velocity)
        return area / math.prod(contact.grid.size)

    @typed
    def impacts(self, velocities: float | Iterable[float]) -> Iterator[RepeatedImpact]:
        """Let the bodies collide, and change their surfaces.

        Args:
            velocities: Impact velocities (m/s), or one for impacts without end.

        Yields:
            Each impact.

        Raises:
            CaseError: A velocity is not positive, or a body has no density.
            DomainError: A contact is larger than the surface.
            NotConvergedError: A solve did not converge.
        """
        listed = repeat(velocities) if isinstance(velocities, (int, float)) else velocities
        for velocity in listed:
            yield self.hit(float(velocity), *self._next_places())

    @typed
    def hit(self, velocity: float, first: Shift, second: Shift) -> RepeatedImpact:
        """Let the bodies collide once, and change their surfaces.

        Args:
            velocity: Impact velocity (m/s).
            first: Node of the first body at which it is hit.
            second: Node of the second body at which it is hit.

        Returns:
            The impact.

        Raises:
            CaseError: The velocity is not positive, or a body has no density.
            DomainError: The contact is larger than the surface.
            NotConvergedError: A solve did not converge.
        """
        state, collision, end = self._collide(velocity, (first, second))
        self._wear((first, second), end)
        self._count += 1
        self._coverage += self.coverage_of(velocity)
        return RepeatedImpact.of(self._count, self._coverage, velocity, state, collision)

    @typed
    def probe(self, velocity: float, places: int, seed: int) -> Iterator[RepeatedImpact]:
        """Let the bodies collide at other places, each time with the surfaces as they are now.

        Args:
            velocity: Impact velocity (m/s).
            places: Number of impacts.
            seed: Seed of the places.

        Yields:
            Each impact.

        Raises:
            CaseError: A velocity is not positive, or a body has no density.
            DomainError: A contact is larger than the surface.
            NotConvergedError: A solve did not converge.
        """
        random = np.random.default_rng(seed)
        for _ in range(places):
            state, collision, _ = self._collide(velocity, self._draw(random))
            yield RepeatedImpact.of(self._count, self._coverage, velocity, state, collision)

    def _draw(self, random: np.random.Generator) -> tuple[Shift, Shift]:
        nx, ny = self._contact.grid.nodes
        middle = nx // 2, ny // 2
        # Shares of the period, so that a coarser grid is hit at the same places.
        first, second = ((int(x * nx), int(y * ny)) for x, y in random.random((2, 2)))
        if self._place == "same":
            return middle, middle
        if self._place == "track":
            wall_first = math.isinf(self._contact.pair.first.radius)
            return (middle, second) if wall_first else (first, middle)
        return first, second

    def _next_places(self) -> tuple[Shift, Shift]:
        return self._draw(self._places)

    def _collide(self, velocity: float, at: tuple[Shift, Shift]) -> tuple[State, Collision, State]:
        """Deepest state, collision, and the state after separation."""
        nodes, spacing = min(self._contact.grid.nodes), min(self._contact.grid.spacing)
        if not self._width:
            area = nominal_area(self._contact.pair, self._contact.hardness, velocity)
            self._width = _rounded(_FIRST_WINDOW * math.sqrt(area / math.pi) / spacing)
        while True:
            contact = self._window(at)
            whole = self._width >= nodes
            try:
                flat, round_ = _depths(contact, velocity)
                near = max(_SHALLOWER * (flat + self._deeper * round_), _LEAST * round_)
                state = solve_at_velocity(contact, velocity, near=near)
                self._deeper = (state.indentation - flat) / round_
                reach = largest_reach(contact, state.indentation + self._range)
                if whole or reach < 0.5 * spacing * self._width:
                    break
            except EdgeReachedError as error:
                if whole:
                    raise DomainError(
                        f"the contact at {velocity:.4g} m/s is larger than the surface, which "
                        "repeats; use a larger surface or a lower velocity",
                        argument="velocity",
                    ) from error
            self._width = _rounded(_WIDER * self._width)
        if not contact.adhesive:
            return state, collide(state), state
        path = list(unloading_path(state))
        return state, collide(state, path), path[-1]

    def _window(self, at: tuple[Shift, Shift]) -> Contact:
        (nx, ny), spacing = self._contact.grid.nodes, self._contact.grid.spacing
        width = min(self._width, nx), min(self._width, ny)
        parts = [body.nodes(centre, width) for body, centre in zip(self._bodies, at, strict=True)]
        seen = list(zip(self._bodies, parts, strict=True))
        height = sum((body.height[part] for body, part in seen), np.zeros(width))
        model = self._contact.plasticity
        if model.grows:
            borne = [body.borne[part] for body, part in seen if body.yields]
            model = remembering(model, np.minimum.reduce(borne))
        companion = self._contact.surface.provenance.get(COMPANION, "")
        origin = {"source": "repeated impacts", COMPANION: companion}
        surface = Surface(freeze(height), Grid(width, spacing), origin)
        return replace(self._contact, surface=surface, plasticity=model)

    def _wear(self, at: tuple[Shift, Shift], end: State) -> None:
        """Lower the surfaces by the plastic displacement; at each node the softer body yields."""
        given = end.plastic_displacement
        if not given.any():
            return
        width = end.contact.grid.nodes
        bound = np.broadcast_to(end.bound, width)
        worn = [
            (body, body.nodes(centre, width))
            for body, centre in zip(self._bodies, at, strict=True)
            if body.yields
        ]
        alike = end.contact.plasticity.alike
        soft = [body.borne[part] <= alike * bound for body, part in worn]
        share = given / np.sum(soft, axis=0)
        for (body, part), softer in zip(worn, soft, strict=True):
            body.height[part] -= np.where(softer, share, 0.0)
            if body.remembers:
                old = body.borne[part]
                higher = softer & (given > 0) & (bound > old)
                body.borne[part] = np.where(higher, bound, old)


def _depths(contact: Contact, velocity: float) -> tuple[float, float]:
    """Indentation (m) of the impact if the hardness acted on all overlap; that of Hertz (m)."""
    pair = contact.pair
    work = 0.5 * mass_in_impact(pair, velocity) * velocity**2
    hertz = Hertz(pair.radius, pair.contact_modulus)
    volume = work / (min(contact.hardness, pair.contact_modulus) * contact.grid.cell_area)
    gap = np.sort(contact.gap, axis=None)
    below = np.cumsum(gap)
    count = np.arange(1, gap.size + 1)
    last = int(np.searchsorted(count * gap - below, volume))
    depth = (volume + below[last - 1]) / last
    return float(depth), float(hertz.indentation_from_energy(work))


def nominal_area(pair: Pair, hardness: float, velocity: float) -> float:
    """Area (m²) of the contact of smooth bodies at the impact velocity (m/s).

    Source: C. Thornton, Z. Ning, Powder Technol. 99 (1998) 154–162, for the indentation.
    """
    mass = mass_in_impact(pair, velocity)
    smooth = ThorntonNing(pair.radius, pair.contact_modulus, min(hardness, pair.contact_modulus))
    depth = float(smooth.indentation_from_velocity(velocity, mass))
    return math.pi * predicted_radius(pair, depth, hardness) ** 2


def repeats(surface: Surface) -> bool:
    """Whether opposite edges of `surface` match."""
    z = surface.height
    for axis in (0, 1):
        inside = float(np.mean(np.diff(z, axis=axis) ** 2))
        across = float(np.mean((z.take(0, axis) - z.take(-1, axis)) ** 2))
        if across > _MOST_STEP**2 * inside:
            return False
    return True


def _check(contact: Contact, other: Surface | None, place: str) -> None:
    if place not in get_args(Place):
        raise CaseError(f"place: {place!r} is not one of {', '.join(get_args(Place))}")
    if contact.periodic:
        raise CaseError("contact: two flat bodies do not collide; give a sphere and no periodic")
    if not contact.plasticity.bounds_solve:
        raise CaseError(
            f'plasticity: "{contact.plasticity.label}" defines a single impact; use '
            "ConstantBound or ExpandingCavity"
        )
    if law_of_patches(contact) is not None:
        raise CaseError(
            "adhesion: waves below the grid do not wear; give the surface with all waves, and no "
            f"{type(contact.adhesion).__name__}"
        )
    if other is not None and other.grid != contact.grid:
        raise CaseError("other: is on another grid; give a surface on the grid of contact")
    for surface in (contact.surface, other):
        if surface is not None and not repeats(surface):
            raise CaseError(
                "surface: its opposite edges do not match, so it does not repeat; use a periodic "
                "surface"
            )
    walls = [math.isinf(body.radius) for body in (contact.pair.first, contact.pair.second)]
    if place == "track" and not any(walls):
        raise CaseError('place: "track" needs a wall; give one body the radius inf')


def _rounded(width: float) -> int:
    return _ROUND * math.ceil(width / _ROUND)
