"""Errors of surfaces; `case` replaces their remedy by one in keys of the case file."""

from __future__ import annotations

from typing import Literal

from restitution.errors import SurfaceError

Code = Literal[
    "cells-above-scan",
    "flat-scan",
    "grid-beyond-surface",
    "height-unit-unknown",
    "heights-impossible",
    "masked-pixels",
    "size-impossible",
    "size-unknown",
    "too-few-pixels",
    "too-many-undefined",
    "undefined-pixels",
]


class RefusedSurfaceError(SurfaceError):
    """The surface cannot be made: the reason `fact`, its identifier `code`, and the `remedy`."""

    def __init__(self, code: Code, fact: str, remedy: str) -> None:
        super().__init__(code, fact, remedy)
        self.code, self.fact, self.remedy = code, fact, remedy

    def __str__(self) -> str:
        return f"{self.fact}; {self.remedy}"
