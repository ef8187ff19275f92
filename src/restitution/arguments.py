"""Check the types of arguments by the annotations of a public function or class."""

from __future__ import annotations

import functools
import inspect
import sys
import types
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeVar, Union, cast, get_args, get_origin

from restitution.errors import ArgumentError, shown

Checked = TypeVar("Checked", bound=Callable[..., Any])

# How a value of a class is made, where this is not a call of the class with its own arguments.
_MADE_BY = {
    "State": "solve(contact, indentation)",
    "Surface": "Surface(height, grid), generate_surface(grid, …) or read_surface(file)",
}
_SERIES = (Sequence, Iterable, list, tuple)


def typed(target: Checked) -> Checked:
    """Make a function or a class refuse arguments that do not fit their annotations.

    Checked are classes of this package, arrays, numbers, texts, flags, series of these, and unions.
    The `ArgumentError` names each wrong argument and the right call.
    """
    if isinstance(target, type):
        target.__init__ = _checking(target.__init__, target.__name__, skip=1)  # type: ignore[misc]
        return target
    return cast(Checked, _checking(target, target.__name__))


def _checking(call: Callable[..., Any], name: str, skip: int = 0) -> Callable[..., Any]:
    """Wrap `call`; its first `skip` parameters (self) are left out of messages."""
    signature = inspect.signature(call)
    own = [*signature.parameters.values()][skip:]
    hints: dict[str, Any] = {}

    @functools.wraps(call)
    def checked(*args: Any, **kwargs: Any) -> Any:
        try:
            given = signature.bind(*args, **kwargs).arguments
        except TypeError as error:
            raise ArgumentError(f"{name}(): {error}; call {_call(name, own)}") from None
        if not hints:
            hints.update(_hints(call, signature))
        wrong = {key: hints[key] for key in hints if key in given}
        wrong = {key: hint for key, hint in wrong.items() if not _fits(given[key], hint)}
        if wrong:
            problems = "; ".join(
                f"{key}: {_described(given[key])} is not {_words(hint)}"
                for key, hint in wrong.items()
            )
            makers = dict.fromkeys(maker for hint in wrong.values() for maker in _makers(hint))
            calls = " and ".join(makers)
            right = _call(name, own, wrong) + (f", with {calls}" if calls else "")
            raise ArgumentError(f"{problems}; call {right}")
        return call(*args, **kwargs)

    return checked


def _hints(call: Callable[..., Any], signature: inspect.Signature) -> dict[str, Any]:
    """The annotations of `signature`, except names that are imported for type checkers alone."""
    known = vars(sys.modules[call.__module__])
    hints = {}
    for key, parameter in signature.parameters.items():
        if parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
            continue
        hint = parameter.annotation
        try:
            hints[key] = eval(hint, dict(known)) if isinstance(hint, str) else hint
        except (NameError, TypeError):
            continue
    return hints


def _own(hint: Any) -> bool:
    return isinstance(hint, type) and hint.__module__.startswith("restitution.")


def _members(hint: Any) -> tuple[Any, ...]:
    return get_args(hint) if get_origin(hint) in (Union, types.UnionType) else (hint,)


def _fits(value: object, hint: Any) -> bool:
    return any(_fits_one(value, member) for member in _members(hint))


def _fits_one(value: object, hint: Any) -> bool:
    if hint is None or hint is type(None):
        return value is None
    if _own(hint) or hint is str:
        return isinstance(value, hint)
    if hint in (int, float):
        scalar = hasattr(value, "__float__") and getattr(value, "shape", ()) == ()
        return scalar and not isinstance(value, bool)
    if hint is bool:
        return not isinstance(value, str) and not _own(type(value))
    if _is_array(hint):
        return getattr(getattr(value, "dtype", None), "kind", "") in tuple("buif")
    if item := _item(hint):
        listed = not isinstance(value, list | tuple) or all(_fits(one, item) for one in value)
        return hasattr(value, "__iter__") and listed
    return True


def _is_array(hint: Any) -> bool:
    return getattr(get_origin(hint), "__name__", "") == "ndarray"


def _item(hint: Any) -> Any:
    """The class of this package that a series such as `Sequence[Surface]` contains, or None."""
    item = (*get_args(hint), None)[0]
    return item if get_origin(hint) in _SERIES and _own(item) else None


def _words(hint: Any) -> str:
    return " or ".join(dict.fromkeys(map(_word, _members(hint))))


def _word(hint: Any) -> str:
    simple: Mapping[Any, str] = {str: "a text", int: "a number", float: "a number", bool: "a flag"}
    if hint in (None, type(None)):
        return "None"
    if _is_array(hint):
        return "an array of numbers"
    if item := _item(hint):
        return f"a list of {item.__name__}"
    return simple.get(hint) or f"a {getattr(hint, '__name__', hint)}"


def _described(value: object) -> str:
    if shape := getattr(value, "shape", ()):
        return f"an array of shape {shape} of {getattr(value, 'dtype', 'objects')}"
    if _own(type(value)) or isinstance(value, list | tuple | dict):
        return f"a {type(value).__name__}"
    if value is None or isinstance(value, str | bool | int | float | complex):
        return shown(value)
    return f"an object of type {type(value).__name__}"


def _makers(hint: Any) -> Iterator[str]:
    for member in _members(hint):
        kind = _item(member) or member
        if _own(kind):
            parameters = [*inspect.signature(kind).parameters.values()]
            yield _MADE_BY.get(kind.__name__) or _call(kind.__name__, parameters)
        elif _is_array(member):
            yield "numpy.array(…)"


def _call(name: str, parameters: Sequence[inspect.Parameter], also: Iterable[str] = ()) -> str:
    """Write the call of `name` with the arguments that it needs, and those named in `also`."""
    parts = []
    for p in parameters:
        needed = p.default is p.empty and p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)
        if needed or p.name in also:
            later = p.kind == p.KEYWORD_ONLY or not needed
            parts.append(f"{p.name}=…" if later else p.name)
    return f"{name}({', '.join(parts)})"
