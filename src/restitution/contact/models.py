"""The interfaces of the models of plasticity and adhesion, which are values of a `Contact`.

A new model is one class that derives from `Plasticity`, or from `cohesive.law.CohesiveLaw`.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from restitution.errors import CaseError
from restitution.numerics.read_only import freeze
from restitution.theory import JKR

if TYPE_CHECKING:
    from restitution.contact.bodies import Pair
    from restitution.contact.checks.findings import Finding
    from restitution.contact.contact import Contact
    from restitution.contact.state import Array, State

Load = Callable[["Contact", float, "State | None"], "State"]

# Pressure of first yield, as a fraction of that of full plasticity.
_ONSET = 1.6 / 2.8
COMPANION = "companion"  # provenance key of a surface that only serves to compare grids
EQUILIBRIUM_SEPARATION = 0.3e-9  # default range of the attraction z₀ (m)
RESTITUTION_ERROR = 0.002  # error of COR that the steps of unloading may cause, by default
WORK_RESIDUAL = 1e-6  # tolerance of intermediate solves; the force is far more accurate than this


class Plasticity(ABC):
    """How bodies yield: a bound of the contact pressure, and the rule of its plastic work.

    The state of loading must not depend on the path, so a bound is a function of the indentation.

    Attributes:
        label: Name of the model in case files and results.
        bytes_per_node: Memory of a run per node of the grid (bytes).
        grows: Whether the bound grows with the indentation, so that the plastic work is summed over
            increments (bool).
        bounds_solve: Whether the pressure is bounded in the solve; otherwise `finish` truncates the
            elastic pressure (bool).
        for_periodic: Whether the model is defined for periodic contacts (bool).
        strengths: Names of the fields that are strengths of the material.
        alike: Ratio of the bounds of two bodies at a node up to which both yield in later impacts
            (dimensionless).
        size_effect: Depth h* (m) from which small contacts are harder (docs/size-effect.md); 0
            without.
    """

    label: ClassVar[str]
    bytes_per_node: ClassVar[float] = 190.0
    grows: ClassVar[bool] = False
    bounds_solve: ClassVar[bool] = True
    for_periodic: ClassVar[bool] = True
    strengths: ClassVar[tuple[str, ...]] = ()
    alike: ClassVar[float] = 1.0
    size_effect: float = 0.0

    def scaled(self, factor: float) -> Plasticity:
        changed = {name: factor * getattr(self, name) for name in self.strengths}
        return replace(self, **changed)  # type: ignore[type-var]

    @property
    @abstractmethod
    def hardness(self) -> float:
        """Pressure of a fully plastic contact (Pa); inf for elastic bodies."""

    @property
    def exact_work(self) -> bool:
        """Whether the plastic work of loading is known without integration."""
        return self.bounds_solve and not self.grows

    @abstractmethod
    def describe(self) -> str:
        """Words for `repr(contact)`."""

    def check(self, pair: Pair) -> None:
        """Raise `CaseError` if a value is impossible for the bodies `pair`."""

    def first_yield_pressure(self, pair: Pair) -> float:
        """Largest pressure at which smooth bodies stay elastic (Pa); inf for elastic bodies."""
        return self.hardness

    def of_smooth(self, pair: Pair) -> Plasticity:
        """The model without size effect by which smooth bodies yield as they do with it."""
        return self

    def onset_pressure(self, pair: Pair) -> float:
        """Pressure (Pa) from which on the model differs from real bodies that yield."""
        return _ONSET * self.hardness

    def bound(
        self, contact: Contact, indentation: float, residual: float
    ) -> tuple[Array | float, int]:
        """Bound of the pressure (Pa), and the number of convolutions that it took.

        The bound is one number, or a read-only array of shape `grid.nodes`. `residual` is the
        tolerance of the solve under this bound.
        """
        return self.hardness, 0

    def bound_after(
        self, state: State, indentation: float, residual: float
    ) -> tuple[Array | float, int]:
        """Return the results of `bound` for a step from `state`; no node softens."""
        if indentation <= state.indentation:
            return state.bound, 0
        limit, convolutions = self.bound(state.contact, indentation, residual)
        if isinstance(limit, np.ndarray):
            limit = freeze(np.maximum(limit, state.bound))
        return limit, convolutions

    def require_step(self, state: State, indentation: float) -> None:
        """Raise `CaseError` if the model does not define a step from `state`."""

    def finish(self, state: State) -> State:
        """Change a state that a solve from the undeformed bodies has returned."""
        return state

    def work(self, before: State | None, after: State) -> tuple[float, float]:
        """Plastic work (J) between two states, and its error (J); None is the undeformed body."""
        bound, volume = after.bound, after.plastic_volume
        if isinstance(bound, np.ndarray):
            box = after.box
            given = after.plastic_displacement[box]
            if before is not None:
                given = given - before.plastic_displacement[box]
            return float(np.sum(bound[box] * given)) * after.contact.grid.cell_area, 0.0
        if math.isinf(bound):
            return 0.0, 0.0
        return bound * (volume - (0.0 if before is None else before.plastic_volume)), 0.0

    def with_loading_work(self, state: State, start: State | None, load: Load) -> State:
        """Add the plastic work of loading from `start` (None: first touch), if not yet in `state`.

        `load` solves the contact at a depth (m), from a shallower state or None.
        """
        return state

    def of_asperities(self, pair: Pair, elastic_pressure: float) -> Plasticity:
        """The model of asperities whose mean contact pressure (Pa), if elastic, has this value."""
        return self

    def bound_of_waves(
        self, contact: Contact, depth: float, measure: Array, nominal: float
    ) -> Array:
        """Bound (Pa) at each node of a patch of short waves, at a `depth` (m).

        `measure` (Pa) is the elastic pressure at twice the indentation divided by √2, `nominal`
        (Pa) the nominal pressure there.
        """
        return np.full(measure.shape, self.hardness)

    def smooth_bounds(self, pair: Pair, count: int) -> tuple[Array, Array]:
        """`count` values of `measure` (Pa) up to full plasticity, and their bounds (Pa)."""
        values = np.full(count, self.hardness)
        return values, values

    def hardness_error(self, state: State) -> float:
        """Relative error of the hardness that contacts as large as in `state` have."""
        return 0.0

    def difference(self, contact: Contact, restitution: float) -> float:
        """Largest relative difference from finite elements, at the COR due to plasticity alone.

        1 if the model has not been compared with finite elements.
        """
        return 1.0


@dataclass(frozen=True)
class Separation:
    """Result of unloading to separation: energies (J), force (N) and indentation (m).

    `error` is the error of `unloading_work`.
    """

    unloading_work: float
    error: float
    adhesive_loss: float
    pull_off_force: float
    separation_indentation: float
    convolutions: int
    steps: int


@lru_cache
def adhesive_length(pair: Pair, work_of_adhesion: float) -> float:
    """(w²R*/E*²)^⅓ (m)."""
    return float(JKR(pair.radius, pair.contact_modulus, work_of_adhesion).adhesive_length)


class Adhesion(ABC):
    """How surfaces attract each other, and the solves, paths, checks and errors that follow.

    Attributes:
        label: Name of the model in case files and results.
        bytes_per_node: Memory of a run per node of the grid (bytes).
        follows_path: Whether loading follows a path, so that a deeper solve should start from a
            shallower state (bool).
        attracts: Whether the surfaces attract each other (bool).
        work_of_adhesion: Work of adhesion w (J/m²).
        equilibrium_separation: Gap z₀ (m) at which the traction between flat surfaces is zero.
    """

    label: ClassVar[str]
    bytes_per_node: ClassVar[float] = 0.0
    follows_path: ClassVar[bool] = False
    attracts: ClassVar[bool] = True
    work_of_adhesion: float
    equilibrium_separation: float

    def of_contact(self, contact: Contact) -> Adhesion:
        """The model between the bodies of `contact`, of which it may be a function."""
        return self

    def with_work_of_adhesion(self, work_of_adhesion: float) -> Adhesion:
        """Copy with another work of adhesion (J/m²)."""
        return replace(self, work_of_adhesion=work_of_adhesion)  # type: ignore[type-var]

    def with_work_tolerance(self, tolerance: float) -> Adhesion:
        """Copy whose loading work may have this relative error, if the model has a choice."""
        return self

    def length(self, pair: Pair) -> float:
        """Length scale of adhesion (w²R*/E*²)^⅓ (m); 0 between flat bodies."""
        if pair.flat:
            return 0.0
        return adhesive_length(pair, self.work_of_adhesion)

    def residual_length(self, pair: Pair, indentation: float) -> float:
        """Length by which the residuals of a solve at `indentation` (m) are divided (m)."""
        return max(abs(indentation), self.length(pair) or self.equilibrium_separation)

    @abstractmethod
    def describe(self, unloading: str) -> dict[str, str]:
        """Entries of the model in `summary.json`; `unloading` is the method of unloading."""

    def check(self, contact: Contact) -> None:
        """Raise `CaseError` if the model is not defined for `contact`."""

    @abstractmethod
    def load(
        self, contact: Contact, indentation: float, *, start: State | None, residual: float
    ) -> State:
        """Load the undeformed bodies to `indentation` (m); the loading work can be missing."""

    @abstractmethod
    def with_work(self, state: State, start: State | None) -> State:
        """Add the loading work to a state from `load`; an integral begins at `start`."""

    @abstractmethod
    def integrates_work(self, contact: Contact) -> bool:
        """Whether the loading work is integrated numerically and so has an error."""

    @abstractmethod
    def step(self, state: State, indentation: float, residual: float) -> State:
        """Move a deformed contact to another indentation (m)."""

    def enclose(
        self,
        contact: Contact,
        reached: Callable[[State], bool],
        ahead: Callable[[State, float], float],
        *,
        start: State | None,
        scale: float,
        residual: float,
    ) -> tuple[State, State] | None:
        """Last state of loading that is not `reached` and the first that is; None: no path.

        `ahead` estimates the distance (m) left from a state and the stiffness there (N/m). `scale`
        is an energy (J) of which the error of a step may be a fraction; 0 for that of the step.
        """
        return None

    def first_depth(self, contact: Contact, work: float, shallow: float) -> float:
        """First guess of the depth (m) of a loading work (J); `shallow` is that of Hertz (m)."""
        return shallow

    @abstractmethod
    def unload(
        self, state: State, *, steps: int, tolerance: float, residual: float, known: Sequence[State]
    ) -> Iterator[State]:
        """Yield `state` and the states of unloading to separation, as `unloading_path`."""

    @abstractmethod
    def separation_of(self, path: list[State]) -> Separation:
        """Energies, pull-off force and error of an unloading `path`."""

    def yielding(self, state: State) -> Iterator[tuple[Contact, float, Array]]:
        """Contacts in which `state` yields, their indentation (m), and plastic work at nodes (J).

        They are without attraction.
        """
        given = state.plastic_displacement
        work = given * (state.plastic_work / (float(given.sum()) or 1.0))
        yield replace(state.contact, adhesion=None), state.indentation, work

    def attraction_energy(self, state: State) -> float:
        """Energy (J) that the attraction has given to a loaded state, without dissipation."""
        return self.work_of_adhesion * state.contact_area

    def unbalance(self, state: State, end: State, work: float, lost: float) -> float:
        """Relative error of the energy balance of an unloading (dimensionless).

        `work` (J) is the unloading work, and `lost` (J) the energy dissipated by adhesion.
        """
        return (work + lost) / state.stored_energy - 1

    def release_error(self) -> float:
        """Error of the unloading work per contact area (J/m²) that finer steps do not reduce."""
        return 0.0

    def node_stiffness(self, state: State) -> Array | None:
        """Stiffness of the attraction at each node (Pa/m); None without range."""
        return None

    def coarsest_spacing(self, pair: Pair) -> float:
        """Largest grid spacing (m) that resolves the range of the attraction; inf without range."""
        return math.inf

    def resolves_range(self, contact: Contact) -> bool:
        """Whether the cells of the grid resolve the range of the attraction."""
        return max(contact.grid.spacing) <= self.coarsest_spacing(contact.pair)

    @abstractmethod
    def needed_spacing(self, state: State) -> float:
        """Largest grid spacing (m) that resolves adhesion on the asperities in contact."""

    def grid_finding(self, contact: Contact) -> Finding | None:
        """Finding if the grid is too coarse to solve `contact`."""
        return None

    def expected_pull_off_error(self, contact: Contact) -> float:
        """Expected relative error of the pull-off force of smooth spheres on this grid."""
        return 0.0

    def range_error(self, state: State, restitution: float) -> float:
        """Error of COR because the model neglects the range of the attraction."""
        return 0.0

    def pull_off_error(self, state: State) -> float:
        """Relative error of the pull-off force due to the model."""
        return 0.0


def set_field(model: Plasticity | Adhesion, name: str, unit: str, *, finite: bool = True) -> None:
    """Make a field a positive Python float, which the compiled loops need, or raise `CaseError`."""
    value = float(getattr(model, name))
    if not value > 0 or (finite and value == math.inf):
        raise CaseError(f"{name}: {value} {unit} is not positive{' and finite' * finite}")
    object.__setattr__(model, name, value)
