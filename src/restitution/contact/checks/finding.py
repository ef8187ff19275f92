"""A finding: what a check has found, as data. `runs.messages` has the sentences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Literal

Code = Literal[
    # The contact cannot be solved, or not with a meaning.
    "roughness-above-radius",
    "contact-beyond-radius",
    "pixel-above-contact",
    "edge-reached",
    # The input may be wrong, or the grid too small or too coarse.
    "contact-beyond-grid",
    "few-nodes",
    "no-half-space",
    "finer-than-scan",
    "tilted-scan",
    "edge-predicted",
    "steep-surface",
    "unusual-yield-pressure",
    "oblong-pixels",
    "coarser-than-scan",
    "surface-notice",
    # The grid does not resolve what was solved.
    "patches-unresolved",
    "adhesion-unresolved",
]


@dataclass(frozen=True)
class Finding:
    """What a check has found: its code, and the values that bear on it by name (SI units).

    The function that makes a finding says which values it has. `values` is read-only.
    """

    code: Code
    values: Mapping[str, Any] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))

    def __getitem__(self, name: str) -> Any:
        return self.values[name]

    def __reduce__(self) -> tuple[type[Finding], tuple[Code, dict[str, Any]]]:
        return Finding, (self.code, dict(self.values))  # read-only mappings cannot be pickled
