"""Errors that the user can fix: one sentence with the key, file or quantity, and the remedy."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from pydantic import ValidationError


class RestitutionError(Exception):
    """A problem with the input or the computation; the message says what to change.

    The message begins with the name of the `argument` at fault, if this is known.
    """

    def __init__(self, *words: object, argument: str = "") -> None:
        super().__init__(*((f"{argument}: {words[0]}",) if argument else words))
        self.argument = argument

    def renamed(self, keys: Mapping[str, str]) -> Self:
        """Name the key of a case file instead of the argument.

        Args:
            keys: Keys by argument.

        Returns:
            An error about the key, or this error if its argument has no key.
        """
        if self.argument not in keys:
            return self
        text = str(self).removeprefix(f"{self.argument}: ")
        return type(self)(text, argument=keys[self.argument])


class CaseError(RestitutionError, ValueError):
    """Invalid values in a case file or in the arguments of a function."""


class ArgumentError(CaseError, TypeError):
    """An argument of a public function has a wrong type, is missing or is unknown."""


class SurfaceError(RestitutionError, ValueError):
    """A surface or a topography file is not suitable for the requested operation."""


class NotConvergedError(RestitutionError):
    """A solve, loading or unloading did not reach its tolerance or end; there is no result."""


class DomainError(RestitutionError):
    """The contact reaches the edge of the grid, or a value lies outside the computed range."""


class OutputError(RestitutionError):
    """A results folder or file is missing, damaged, not writable, or must not be overwritten."""


def first_problem(error: ValidationError) -> str:
    """Describe the first problem that pydantic found: the key, and what is wrong."""
    first = error.errors(include_url=False)[0]
    where = ".".join(map(str, first["loc"]))
    why = first["msg"].removeprefix("Value error, ")
    return f"{where}: {why}" if where else why


def one_line(text: str) -> str:
    """Escape line breaks and other control characters in `text`, so that it stays on one line."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def did_you_mean(word: str, known: Iterable[str], alike: float = 0.6) -> str:
    """A question that suggests the most similar word; "" below the similarity `alike` (0 to 1)."""
    near = difflib.get_close_matches(word, list(known), n=1, cutoff=alike)
    return f'did you mean "{near[0]}"?' if near else ""


def not_one_of(word: str, known: Iterable[str]) -> str:
    """Describe a word that is not among the words `known`; suggest the most similar one."""
    words = list(known)
    hint = did_you_mean(word, words)
    return f"{shown(word)} is not one of {', '.join(words)}{hint and f'; {hint}'}"


def shown(value: object, limit: int = 60) -> str:
    """Format a user's value for a message: one line of at most `limit` characters, texts quoted."""
    if isinstance(value, bool):
        return str(value).lower()  # TOML writes true and false in lower case
    try:
        text = one_line(value if isinstance(value, str) else repr(value))
    except ValueError:  # Python refuses to print an integer of more than 4300 digits
        return "a number of thousands of digits"
    text = text if len(text) <= limit else f"{text[: limit - 1]}…"
    return f'"{text}"' if isinstance(value, str) else text
