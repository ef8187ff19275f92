"""The compiled loops, and the choice between a loop and the array expression of the same name.

The hot operations are written twice: as an expression of whole arrays, which holds on any device,
and as a loop in C++ that does the same in one pass over memory. Tests compare the two. Without a
compiler the expressions do all the work.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from importlib import import_module
from typing import Any, ParamSpec, TypeVar

import numpy as np

try:
    loops: Any = import_module("restitution.numerics.loops")
except ImportError:  # built without a compiler, or for another processor
    loops = None

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def use_loop(expression: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Decorate `expression` so that its compiled loop is called where the first array allows it."""
    if loops is None:
        return expression
    loop = getattr(loops, expression.__name__)

    @wraps(expression)
    def either(*args: Any) -> Any:
        return loop(*args) if loop_takes(args[0]) else expression(*args)  # type: ignore[call-arg]

    return either  # type: ignore[return-value]


def loop_takes(values: Any) -> bool:
    """Whether `values` is a NumPy matrix whose rows are contiguous, as loops require."""
    if loops is None or type(values) is not np.ndarray or values.ndim != 2:
        return False
    return values.strides[1] == values.itemsize or values.shape[1] < 2
