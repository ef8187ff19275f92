"""Choose compiled kernels or NumPy expressions, and the instruction set of the kernels.

Each time-critical operation is a NumPy expression, which works on any device, and a C++ loop of the
same name in `restitution.numerics.loops`. RESTITUTION_KERNELS ("avx512", "avx2", "plain" or
"numpy") is read once; the default is the widest vectors that the processor supports.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import wraps
from importlib import import_module
from typing import Any, ParamSpec, TypeVar

import numpy as np

from restitution.errors import CaseError, one_line, shown

VARIABLE = "RESTITUTION_KERNELS"
INSTRUCTION_SETS = {"avx512": "AVX-512", "avx2": "AVX2", "plain": "plain"}

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def _load() -> tuple[Any, str]:
    wanted = os.environ.get(VARIABLE, "")
    if wanted == "numpy":
        return None, f"{VARIABLE} is numpy; unset it"
    if wanted and wanted not in INSTRUCTION_SETS:
        known = ", ".join((*INSTRUCTION_SETS, "numpy"))
        raise CaseError(f"{VARIABLE}: {shown(wanted)} is not known; unset it, or use {known}")
    try:
        return import_module("restitution.numerics.loops"), ""
    except ModuleNotFoundError:
        reason = "the kernels were not compiled when the package was installed"
    except ImportError as error:
        reason = one_line(str(error))
    if wanted:
        raise CaseError(
            f"{VARIABLE}: {wanted} kernels cannot be loaded ({reason}); unset this environment "
            "variable"
        )
    return None, f"{reason}; install with a C++ compiler (GCC or Clang), or from a wheel"


loops, _reason = _load()
instruction_set: str = INSTRUCTION_SETS[loops.instruction_set] if loops else "none"


def missing() -> str | None:
    """Return None if compiled kernels are used, else a message with the reason and a remedy."""
    if loops is not None:
        return None
    return f"NumPy replaces the compiled kernels and takes 3 to 6 times as long: {_reason}"


def use_loop(expression: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Decorate a NumPy expression to call the compiled loop if `loop_takes` its first argument."""
    if loops is None:
        return expression
    loop = getattr(loops, expression.__name__)

    @wraps(expression)
    def either(*args: Any) -> Any:
        return loop(*args) if loop_takes(args[0]) else expression(*args)  # type: ignore[call-arg]

    return either  # type: ignore[return-value]


def loop_takes(values: Any) -> bool:
    """Whether compiled loops are loaded and `values` is a 2D NumPy array with contiguous rows."""
    return (
        loops is not None
        and type(values) is np.ndarray
        and values.ndim == 2
        and (values.strides[1] == values.itemsize or values.shape[1] < 2)
    )
