"""The package with a part of its text changed, to see what that part is worth."""

from __future__ import annotations

import inspect
from collections.abc import Callable


def changed(function: Callable, *changes: tuple[str, str]) -> Callable:
    """The function with other texts for some of its own; `LookupError` if it has no such text."""
    source = inspect.getsource(function)
    for old, new in changes:
        if old not in source:
            raise LookupError(f"{function.__name__} does not hold {old!r} any more")
        source = source.replace(old, new)
    names = dict(vars(inspect.getmodule(function)))
    exec(compile(source, function.__name__, "exec"), names)
    return names[function.__name__]
