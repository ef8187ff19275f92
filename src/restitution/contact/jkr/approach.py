"""How adhesion acts during loading in the JKR limit."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar

from restitution.arguments import typed
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import solve_nonadhesive
from restitution.contact.jkr.area import grow_contact, jkr_of, unload_adhesive
from restitution.contact.state import Array, State
from restitution.numerics.box import bounding_box

# Retraction after each loading increment (m) (Ghanbarzadeh et al. 2019, §2.2).
PULL_INCREMENT = 1e-10


class Approach(ABC):
    """How adhesion acts during loading.

    Attributes:
        label: Name in case files and results.
        attracts: Whether adhesion does work during loading (bool).
        in_equilibrium: Whether each state is an adhesive equilibrium, so that the contact begins by
            a jump at first touch (bool).
        pinning: Error of the loading work because loading steps influence which nodes attach, as a
            fraction of the work of adhesion times the contact area. In validation contacts, 93 % of
            29 works in equilibrium and all of 11 with pull increments differed by less than this
            from the work of 240 steps.
    """

    label: ClassVar[str]
    attracts: ClassVar[bool] = True
    in_equilibrium: ClassVar[bool] = False
    pinning: ClassVar[float] = 0.0

    @abstractmethod
    def load(
        self,
        contact: Contact,
        indentation: float,
        start: State | None,
        residual: float,
        limit: Array | float,
    ) -> State:
        """Load the undeformed bodies to `indentation` (m) under the bound `limit` (Pa)."""


@typed
@dataclass(frozen=True)
class AdhesiveApproach(Approach):
    """Loading finds the adhesive equilibrium at each depth."""

    label = "equilibrium"
    in_equilibrium = True
    pinning = 0.02

    def load(
        self,
        contact: Contact,
        indentation: float,
        start: State | None,
        residual: float,
        limit: Array | float,
    ) -> State:
        shallower = start if start is not None and start.indentation <= indentation else None
        by_energy = jkr_of(contact).detachment.by_energy
        if shallower is not None and not by_energy:
            box, held = shallower.box, shallower.box_pressure != 0
        else:
            # A contact that grows from a smaller one can stop growing too early, before the energy
            # release rate along its edge has fallen to the work of adhesion. So the search starts
            # from all nodes that overlap at this indentation, and then releases nodes.
            inside = contact.gap <= indentation
            if shallower is not None:
                inside[shallower.box] |= shallower.box_pressure != 0
            around = bounding_box(inside)
            assert around is not None  # the gap is zero at the node that touches first
            box, held = around, inside[around]
        return grow_contact(
            contact,
            indentation,
            box,
            held,
            limit=limit,
            first_guess=None if start is None else start.pressure_on(box),
            residual=residual,
        )


@typed
@dataclass(frozen=True)
class HertzianApproach(Approach):
    """Loading without adhesion."""

    label = "hertzian"
    attracts = False

    def load(
        self,
        contact: Contact,
        indentation: float,
        start: State | None,
        residual: float,
        limit: Array | float,
    ) -> State:
        return solve_nonadhesive(contact, indentation, limit, residual)


@typed
@dataclass(frozen=True)
class PullIncrements(Approach):
    """Loading without adhesion, followed by a retraction of 0.1 nm with adhesion.

    Source:
        A. Ghanbarzadeh et al. (2019), §2.2.
    """

    label = "pull-increments"
    pinning = 0.006

    def load(
        self,
        contact: Contact,
        indentation: float,
        start: State | None,
        residual: float,
        limit: Array | float,
    ) -> State:
        # If the retraction releases all nodes, the result is a state out of contact, not an error.
        pressed = solve_nonadhesive(contact, indentation + PULL_INCREMENT, limit, residual)
        state = unload_adhesive(pressed, indentation, residual=residual)
        return replace(state, adhesive_work=0.0, is_first_loading=True)
