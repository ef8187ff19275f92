"""Choose the coarsest grid that resolves the contact at each depth, for `grid.refine = "auto"`."""

from __future__ import annotations

import math
import time
from bisect import bisect_left
from pathlib import Path

from restitution.case.below_grid import is_on_few_asperities, refines_for_patches
from restitution.case.case import Case
from restitution.contact.checks.resolution import (
    NODES_PER_PATCH,
    adhesive_spacing,
    divisions,
    median_patch,
    resolves_adhesion,
)
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.contact import Contact
from restitution.contact.interface import interface_of
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.patch.law import law_of_patches
from restitution.contact.state import State
from restitution.display import duration, quantity
from restitution.errors import DomainError, NotConvergedError
from restitution.numerics.box import shape_of
from restitution.numerics.grid import Grid
from restitution.numerics.memory import available
from restitution.runs.depths import load_to
from restitution.runs.log import Say, ignore
from restitution.runs.messages import no_range
from restitution.surfaces.refine import FACTORS, divided

# Largest number of nodes of a grid that "auto" tries. Such a grid takes a few minutes and about
# 2 GiB.
MOST_NODES = 2**24
# The same for a contact with an attraction of finite range, and its largest number of nodes near
# the contact, which are solved.
MOST_COHESIVE_NODES, MOST_SOLVED_NODES = 2**22, 2**20
# The same for a grid that is refined although `refine` is not given.
_MOST_IMPLIED = 2**20
# Radius of the real contact area, divided by the longest wave of its patches, from which the error
# with patches is small (evidence/two_scales/refined.csv).
_SEPARATE = 2.0
# Safety factor on the number of nodes that a patch needs, because other surfaces of an ensemble
# may have smaller patches.
_MARGIN = 1.5
# Time of a solve on cells half as large, divided by that on the present cells.
_SLOWER = 4.8
_UNITS = {"indentation": "m", "load": "N", "impact": "m/s", "pressure": "Pa"}


def with_chosen_grids(case: Case, folder: Path, warn: Say = ignore) -> Case:
    """Replace `grid.refine = "auto"` in `case` by a factor for each depth.

    Each depth gets the coarsest grid on which half of the contact nodes lie in patches of at least
    1.5 times `NODES_PER_PATCH` nodes and that resolves adhesion; if no affordable grid does, the
    finest affordable one, and `warn` is called. Deeper contacts have larger patches, so bisection
    finds the shallowest depth that a grid resolves. In an ensemble, the first surface decides. An
    open model of adhesion becomes `cohesive` if an affordable grid resolves its range.

    With waves in patches that are asked for, a grid that is not given is chosen, too: the coarsest
    on which the contact is not small beside the patches.
    """
    implied = refines_for_patches(case, folder)
    if case.grid.refine != "auto" and not implied:
        return case
    case = _with_affordable_adhesion(case, folder, warn)
    depths = case.depths()
    factors: list[int] = []  # the factors so far belong to the largest depths
    kind = _PatchLevel if implied else _Level
    level = kind(case.refined(1), folder)
    finest, why = level, ""
    for factor in FACTORS:
        if factor > 1:
            if why := level.beyond(2):
                break
            level = kind(case.refined(factor), folder)
        finest, why = level, f"{factor} is the largest refine"
        if not level.resolves_range:
            continue
        left = depths[: len(depths) - len(factors)]
        first = bisect_left(left, True, key=level.resolves)
        factors = [factor] * (len(left) - first) + factors
        if first == 0:
            break
    unresolved = depths[: len(depths) - len(factors)]
    if unresolved:
        warn(finest.unresolved(unresolved, why))
    chosen = [finest.case.grid.factor] * len(unresolved) + factors
    if implied and max(chosen) > 1:
        nx, ny = finest.contact.grid.nodes
        warn(
            f"roughness.below_grid: the grid was refined up to {max(chosen)} times ({nx} x {ny} "
            "nodes), because the contact was small beside the patches; grid.refine = 1 keeps it"
        )
    return case.refined(chosen[0] if len(set(chosen)) == 1 else tuple(chosen))


def least_refined(case: Case, folder: Path, warn: Say = ignore) -> Case:
    """Replace `grid.refine = "auto"` by the smallest factor that resolves the range of adhesion.

    Nothing is solved. The factor is 1 if no affordable grid resolves the range, and for other
    contacts.
    """
    if case.grid.refine != "auto":
        return case
    case = _with_affordable_adhesion(case, folder, warn)
    contact = case.refined(1).realisation(0).contact(folder)
    needed = interface_of(contact).coarsest_spacing(contact.pair)
    times = divisions(max(contact.grid.spacing), needed) if math.isfinite(needed) else 1
    finer = divided(contact.grid, times)
    if times == 1 or not _is_affordable(case, finer, needed):
        return case.refined(1)
    return case.refined(times)


def with_chosen_adhesion(case: Case, contact: Contact, warn: Say = ignore) -> Case:
    """State the model of adhesion of `contact` in `case`, so that all its grids use this model."""
    if not contact.adhesive or case.interface.adhesion is not None:
        return case
    for line in no_range(contact):
        warn(line)
    return _with_adhesion(case, "jkr" if isinstance(contact.adhesion, JKRLimit) else "cohesive")


class _Level:
    def __init__(self, case: Case, folder: Path) -> None:
        self.case, self.contact = case, case.realisation(0).contact(folder)
        self._folder = folder
        self._states: dict[float, State | None] = {}
        self._seconds = 0.0

    @property
    def _range(self) -> float:
        return interface_of(self.contact).coarsest_spacing(self.contact.pair)

    @property
    def resolves_range(self) -> bool:
        return interface_of(self.contact).resolves_range(self.contact)

    def resolves(self, depth: float) -> bool:
        """Whether the grid resolves the contact at `depth`, one of the depths of the case."""
        try:
            state = self._state(depth)
        except DomainError:  # the contact reaches the edge; the run will report this
            return True
        return state is not None and self._is_fine(state)

    def _is_fine(self, state: State) -> bool:
        return _has_patches(state) and resolves_adhesion(state)

    def beyond(self, times: int) -> str:
        """Why cells smaller by the factor `times` are not affordable; empty if they are."""
        grid = divided(self.contact.grid, times)
        nx, ny = grid.nodes
        wide = f"the next grid would have {nx} x {ny} nodes"
        if not interface_of(self.contact).follows_path:
            return wide if nx * ny > MOST_NODES else ""
        near = [math.prod(shape_of(state.box)) for state in self._states.values() if state]
        if nx * ny > MOST_COHESIVE_NODES or times**2 * max(near, default=0) > MOST_SOLVED_NODES:
            return wide + self._cost(times)
        return wide if self.case.run_bytes(grid) > available() else ""

    def unresolved(self, depths: list[float], why: str) -> str:
        return (
            f'grid.refine = "auto" stopped at {self.case.grid.factor} ({why}). This grid does not '
            f"resolve the contact {self._where(depths)}: {'; '.join(self._reasons(depths))}; begin "
            f"with a larger {self._name}, or leave out short waves (roughness.shortest)"
        )

    def _where(self, depths: list[float]) -> str:
        unit = _UNITS[self.case.prescribed]
        first, last = (quantity(depth, unit) for depth in (depths[0], depths[-1]))
        return f"at {first}" if first == last else f"from {first} to {last}"

    @property
    def _name(self) -> str:
        key = self.case.prescribed
        return "velocity" if key == "impact" else key

    def _reasons(self, depths: list[float]) -> list[str]:
        states = [state for depth in depths if (state := self._states.get(depth)) is not None]
        reasons = []
        if not self.resolves_range or not all(map(resolves_adhesion, states)):
            needed = min(map(adhesive_spacing, states), default=self._range)
            reasons.append(f"adhesion needs {self._grid_of(needed)}")
        if self.resolves_range and (not states or not all(map(_has_patches, states))):
            reasons.append(
                "half of the contact is in patches of fewer than "
                f"{_MARGIN * NODES_PER_PATCH:.0f} nodes"
            )
        return reasons

    def _grid_of(self, spacing: float) -> str:
        """Describe the grid with cells of `spacing` (m) or less, and what it costs."""
        times = divisions(max(self.contact.grid.spacing), spacing)
        nx, ny = divided(self.contact.grid, times).nodes
        refine = times * self.case.grid.factor
        key = f"grid.refine = {refine}, " if refine <= FACTORS[-1] else ""
        return (
            f"cells of {quantity(spacing, 'm')} or less ({key}{nx} x {ny} nodes{self._cost(times)})"
        )

    def _cost(self, times: int) -> str:
        """Time of solving the depths on cells smaller by the factor `times`; empty if unknown."""
        if not self._states:
            return ""
        for_all = self._seconds * len(self.case.depths()) / len(self._states)
        return f", about {duration(for_all * _SLOWER ** math.log2(times))} without errors"

    def _state(self, depth: float) -> State | None:
        """The state at `depth`; None if it cannot be solved (too few nodes in contact)."""
        if depth not in self._states:
            shallower = [d for d, state in self._states.items() if d < depth and state is not None]
            start = self._states[max(shallower)] if shallower else None
            began = time.perf_counter()
            try:
                self._states[depth] = load_to(self.case, self.contact, depth, start)
            except NotConvergedError:
                self._states[depth] = None
            self._seconds += time.perf_counter() - began
        return self._states[depth]


class _PatchLevel(_Level):
    """A grid without adhesion beside whose contacts the patches must be small."""

    def resolves(self, depth: float) -> bool:
        if law_of_patches(self.contact) is None:
            return True  # the grid carries all waves
        few = is_on_few_asperities(self.case, self._folder, depth)
        return not few and super().resolves(depth)

    def _is_fine(self, state: State) -> bool:
        law = law_of_patches(self.contact)
        radius = math.sqrt(state.contact_area / math.pi)
        return law is None or radius >= _SEPARATE * law.wavelength

    def beyond(self, times: int) -> str:
        nx, ny = divided(self.contact.grid, times).nodes
        return f"the next grid would have {nx} x {ny} nodes" if nx * ny > _MOST_IMPLIED else ""

    def unresolved(self, depths: list[float], why: str) -> str:
        return (
            f"roughness.below_grid: the contact is small beside the patches {self._where(depths)}, "
            f"where COR has a large error; the grid was refined {self.case.grid.factor} times "
            f"({why}). Begin with a larger {self._name}, or set a larger grid.refine"
        )


def _has_patches(state: State) -> bool:
    return median_patch(state.patch_sizes()) >= _MARGIN * NODES_PER_PATCH


def _with_adhesion(case: Case, adhesion: str) -> Case:
    interface = case.interface.model_copy(update={"adhesion": adhesion})
    return case.model_copy(update={"interface": interface})


def _with_affordable_adhesion(case: Case, folder: Path, warn: Say) -> Case:
    """Choose `cohesive` for a case that leaves this open, if an affordable grid resolves it.

    Otherwise choose `jkr`, and `warn` if it neglects a range of the attraction that matters.
    """
    interface = case.interface
    if interface.adhesion is not None or not interface.adhesive_energy or interface.needs_jkr:
        return case
    cohesive = _with_adhesion(case, "cohesive")
    if cohesive.splitting(folder) is not None:
        return cohesive
    grid = case.grid.grid() or case.refined(1).realisation(0).surface(folder).grid
    z0 = interface.equilibrium_separation
    needed = Cohesive(interface.adhesive_energy, z0).coarsest_spacing(case.pair())
    if any(_is_affordable(cohesive, divided(grid, n), needed) for n in FACTORS):
        return cohesive
    jkr = _with_adhesion(case, "jkr")
    for line in no_range(jkr.realisation(0).contact(folder)):
        warn(line)
    return jkr


def _is_affordable(case: Case, grid: Grid, needed: float) -> bool:
    return (
        max(grid.spacing) <= needed
        and math.prod(grid.nodes) <= MOST_COHESIVE_NODES
        and case.run_bytes(grid) <= available()
    )
