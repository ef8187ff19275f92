"""Compiled loops beside the array expressions that they replace."""

import numpy as np
from hypothesis import strategies as st

seeds = st.integers(0, 2**32 - 1)
shapes = st.tuples(st.integers(1, 9), st.integers(1, 40))


def both(operation, *args):
    """Results of the expression and of the loop, each with its arguments after the call."""
    outcomes = []
    for function in (operation.__wrapped__, operation):
        mine = [a.copy() if isinstance(a, np.ndarray) else a for a in args]
        outcomes.append((function(*mine), mine))
    return outcomes
