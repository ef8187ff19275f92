"""A finding: the result of a check, as data. `runs.messages` turns findings into messages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Literal

Code = Literal[
    # Codes of contacts that cannot be solved or would give meaningless results:
    "roughness-above-radius",
    "contact-beyond-radius",
    "pixel-above-contact",
    "edge-reached",
    "range-unresolved",
    "impossible-slope",
    # Codes of contacts whose input may be wrong, or whose grid may be too small or too coarse:
    "contact-beyond-grid",
    "few-nodes",
    "no-half-space",
    "finer-than-scan",
    "spikes",
    "tilted-scan",
    "curved-scan",
    "edge-predicted",
    "steep-surface",
    "unusual-yield-pressure",
    "oblong-pixels",
    "coarser-than-scan",
    "surface-notice",
    # Codes of results that the grid does not resolve:
    "patches-unresolved",
    "adhesion-unresolved",
]


@dataclass(frozen=True)
class Finding:
    """The result of a check: its code and its values by name (SI units).

    The docstring of the function that returns the finding explains its values. `values` is
    read-only.
    """

    code: Code
    values: Mapping[str, Any] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))

    def __getitem__(self, name: str) -> Any:
        return self.values[name]

    def __reduce__(self) -> tuple[type[Finding], tuple[Code, dict[str, Any]]]:
        return Finding, (self.code, dict(self.values))  # read-only mappings cannot be pickled
