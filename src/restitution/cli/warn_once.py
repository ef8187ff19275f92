"""Warnings of one command: each warning is printed once, and repetitions are counted."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

# The message about repetitions quotes at most this number of characters of the repeated warning.
_QUOTED = 60


class Warn(Protocol):
    """A function that issues a warning, optionally about a subject such as a case or a law."""

    def __call__(self, message: str, subject: str = "") -> None:
        """Print `message` with its `subject`, or count it if it was printed before."""


@contextmanager
def warn_once() -> Iterator[Warn]:
    """Print each warning once; at the end, print how often and for which subjects it was repeated.

    A warning that differs from an earlier one only in its numbers counts as a repetition.
    """
    from restitution.cli.console import warn
    from restitution.display import counted, some_of, without_numbers

    first: dict[str, str] = {}
    repeated: dict[str, list[tuple[str, str]]] = {}  # pairs (message, subject) by kind

    def warn_or_count(message: str, subject: str = "") -> None:
        kind = without_numbers(message)
        if kind in first:
            repeated.setdefault(kind, []).append((message, subject))
        else:
            first[kind] = message
            warn(f"{subject}: {message}" if subject else message)

    try:
        yield warn_or_count
    finally:
        for kind, others in repeated.items():
            whole = first[kind]
            start = whole if len(whole) <= _QUOTED else f"{whole[:_QUOTED].rstrip()}…"
            differ = any(message != whole for message, _ in others)
            numbers = " with other numbers" if differ else ""
            named = some_of(subject for _, subject in others)
            which = f" ({named})" if named else ""
            times = counted(len(others), "time")
            warn(f'this warning was repeated {times}{numbers}{which}: "{start}"')
