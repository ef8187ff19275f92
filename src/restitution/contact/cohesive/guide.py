"""Another path of the same bodies, whose states predict those of a step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from restitution.contact.cohesive.equilibrium import CohesiveState
from restitution.contact.state import Array, State
from restitution.numerics.box import Box, reframe

# A step ends at a state of the guide if this changes its length by at most this fraction.
_NEAR = 0.3


@dataclass(frozen=True)
class Guide:
    """States of an unloading path, in its order."""

    path: Sequence[CohesiveState] = ()

    @classmethod
    def of(cls, known: Sequence[State], state: CohesiveState) -> Guide:
        """The `known` states, if they are of the surface of `state`."""
        path = [one for one in known if isinstance(one, CohesiveState)]
        if not path or path[0].contact.surface is not state.contact.surface:
            return cls()
        return cls(path)

    def stop(self, begin: float, end: float) -> float:
        """The indentation of a state near `end`, where a step from `begin` may end instead."""
        stops = [state.indentation for state in self.path]
        near = [at for at in stops if abs(at - end) <= _NEAR * abs(end - begin)]
        return min(near, key=lambda at: abs(at - end)) if near else end

    def change(self, begin: float, end: float, box: Box) -> Array | None:
        """Change of pressure (Pa) on `box` between two indentations; None if the guide jumps."""
        before, after = self._around(begin), self._around(end)
        if before is None or after is None:
            return None
        if len({state.jumps for state in (*before, *after)}) > 1:
            return None
        changed = _between(*after, end, box)
        return changed - _between(*before, begin, box) if changed.any() else None

    def _around(self, at: float) -> tuple[CohesiveState, CohesiveState] | None:
        """The states on either side of an indentation; None beyond the ends."""
        for a, b in zip(self.path[:-1], self.path[1:], strict=True):
            if b.indentation <= at <= a.indentation:
                if at == a.indentation:
                    return a, a
                return (b, b) if at == b.indentation else (a, b)
        return None


def _between(a: CohesiveState, b: CohesiveState, at: float, box: Box) -> Array:
    here = reframe(b.box_pressure, b.box, box)
    if a is b:
        return here
    share = (at - b.indentation) / (a.indentation - b.indentation)
    return here + share * (reframe(a.box_pressure, a.box, box) - here)
