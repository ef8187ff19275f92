"""Curves of adhesive unloading (force against indentation), and a test for equal curves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import dropwhile

import numpy as np

from restitution.contact.jkr.area import balances_are_reliable
from restitution.contact.state import Array, State
from restitution.numerics.quadrature import integrate_curve

_FEW_NODES = 10  # below this number of contact nodes, the mean of G along the edge is unreliable
_SMOOTHED = 11  # `_smoothed` fits each parabola to this number of points

# A change of the force between two points is a jump if it exceeds this fraction of the largest
# tension.
_JUMP = 0.1
# The last two points of a complete curve are the last balance and the separation. They must have
# different indentations, so the indentation at separation is lowered if necessary. The difference
# is then at least this fraction of the decrease of the indentation from the start of unloading to
# the last balance.
_END = 1e-3
# Two forces at one indentation count as equal if their difference is at most this fraction of the
# largest tension or of the force, whichever is larger. Balances scatter by about this fraction.
_SAME = 0.03


@dataclass(frozen=True)
class ForceCurve:
    """Force (N) against decreasing indentation (m), shape (points,).

    If `balanced`, the first point is the state at which unloading begins, and the other points are
    the balances of the contact areas (see `area`); otherwise the points are all states. `fixed`
    means that the contact area is fixed between the first two points, so that the force is linear.
    """

    indentation: Array
    force: Array
    balanced: bool
    fixed: bool = False

    def work(self) -> float:
        x, F = self.indentation, self.force
        if not self.fixed:
            return -integrate_curve(x, F)
        return -float(np.trapezoid(F[:2], x[:2])) - integrate_curve(x[1:], F[1:])

    def halved(self) -> ForceCurve:
        """Return the curve without every second point, to estimate the error of the work.

        The work of this curve has at least four times the error of the work from all points.
        """
        last = self.force.size - 1
        fewer = np.append(np.arange(0, last, 2), last)
        if self.fixed:
            fewer = np.unique([0, *range(1, last, 2), last])
        return replace(self, indentation=self.indentation[fewer], force=self.force[fewer])

    def largest_tension(self) -> float:
        """Largest tension (N). Forces of a balanced curve scatter and are smoothed first."""
        F, largest = self.force, -float(self.force.min())
        if not self.balanced:
            return largest
        # Where contacts snap apart, the force jumps. The curve is smoothed only between the jumps.
        jumps = np.flatnonzero(np.abs(np.diff(F)) > _JUMP * largest) + 1
        smoothed = [
            _smoothed(x, part)
            for x, part in zip(np.split(self.indentation, jumps), np.split(F, jumps), strict=True)
        ]
        return -min(float(part.min()) for part in smoothed)


def unloading_curve(path: list[State]) -> ForceCurve:
    """Return the curve of an unloading `path`.

    Each contact area gives its balance or, if this is unknown or unreliable, all states with this
    area.
    """
    states = [(state.indentation, state.force) for state in path]
    balances = [state.balance for state in path[1:]]
    nodes = [state.contact_nodes for state in path]
    if not any(balances) or not balances_are_reliable(path[0]):
        indentation, force = np.array(states).T
        return ForceCurve(indentation, force, balanced=False)
    points, fixed = states[:1], None
    same_area: list[tuple[float, float]] = []
    for k, balance in enumerate(balances):
        same_area.append(states[k])
        if nodes[k + 1] == nodes[k]:
            continue
        of_area = same_area if balance is None or nodes[k] < _FEW_NODES else [balance]
        points += [point for point in of_area if point[0] < points[-1][0]]
        fixed = len(points) > 1 if fixed is None else fixed
        same_area = []
    indentation, force = np.array(points).T
    return ForceCurve(indentation, force, balanced=True, fixed=bool(fixed))


def complete_curve(path: Sequence[State]) -> list[tuple[float, float]]:
    """Indentations (m) and forces (N) of an unloading `path`, from its first state to zero force.

    Tensions above the pull-off force are due to scatter and are replaced by the pull-off force.
    """
    curve, begin, end = unloading_curve(list(path)), path[0], path[-1]
    if not curve.balanced:
        return [(state.indentation, state.force) for state in path]
    limited = np.maximum(curve.force, -curve.largest_tension())
    limited[0] = begin.force
    points = list(zip(curve.indentation.tolist(), limited.tolist(), strict=True))
    last = points[-1][0]
    below = last - _END * (begin.indentation - last)
    return [*points, (min(end.indentation, below), 0.0)]


def _smoothed(x: Array, F: Array) -> Array:
    window = min(_SMOOTHED, F.size)
    if window < 5:
        return F
    smoothed = np.empty(F.size)
    for k in range(F.size):
        first = min(max(k - window // 2, 0), F.size - window)
        near = slice(first, first + window)
        t = (x[near] - x[k]) / (x[first] - x[first + window - 1])
        value = np.polynomial.polynomial.polyfit(t, F[near], 2)[0]
        smoothed[k] = np.clip(value, F[near].min(), F[near].max())
    return smoothed


@dataclass(frozen=True)
class SharedUnloading:
    """Known states of an elastic unloading, to be reused in unloading from a larger depth."""

    states: Sequence[State]
    curve: ForceCurve

    @classmethod
    def of(cls, state: State, known: Sequence[State]) -> SharedUnloading | None:
        """Prepare the `known` states for reuse in unloading from `state`; None if impossible."""
        if (
            not known
            or known[0].contact is not state.contact
            or known[-1].contact_nodes
            or state.plastic_displacement.any()
            or known[0].plastic_displacement.any()
        ):
            return None
        curve = unloading_curve(list(known))
        return cls(known, curve) if curve.balanced and balances_are_reliable(state) else None

    def agrees(self, state: State) -> bool:
        if state.balance is None:
            return False
        (at, force), x, F = state.balance, self.curve.indentation, self.curve.force
        if not x[1] >= at > x[-1] or not self._following(state):
            return False
        known = float(np.interp(at, x[::-1], F[::-1]))
        return abs(force - known) <= _SAME * max(self.curve.largest_tension(), abs(force))

    def below(self, state: State) -> Iterator[State]:
        """Yield the known states at smaller indentations, with the adhesive work of `state`."""
        following = self._following(state)
        first = following[0]
        fallen = 0.5 * (state.force + first.force) * (state.indentation - first.indentation)
        # The work from `state` to the first known state is computed from the forces of these two
        # states. All later changes of the work are those of the known states.
        offset = first.loading_work - (state.loading_work - fallen)
        for later in following:
            yield replace(
                later,
                adhesive_work=later.adhesive_work + offset,
                convolutions=0,
                force_before_release=first.force if later is first else later.force_before_release,
            )

    def _following(self, state: State) -> list[State]:
        started = dropwhile(lambda known: known.balance is None, self.states)
        return [known for known in started if known.indentation < state.indentation]
