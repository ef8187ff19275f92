"""The yield strength of metals from their hardness, and how uncertain this conversion is."""

from __future__ import annotations

import math
import re
from typing import Any

from restitution.case.materials import Property
from restitution.case.quantities import LONGEST, read_positive
from restitution.contact.plasticity.cavity import FULL_CONSTRAINT
from restitution.errors import shown

# Ratio of hardness to yield strength of metals that hardly harden: 2.8 to 3 in indentation tests
# (D. Tabor, The Hardness of Metals, 1951); 2.7 to 2.2, falling with the hardness, in rebound tests
# of steels of 240 to 920 HV (evidence/experiments).
MOST, LEAST = 3.0, 2.2
_RULE = re.compile(r"\s*H\s*/\s*(\d+(?:\.\d*)?|\.\d+)\s*")


def ratio_of(value: Any) -> float | None:
    """The ratio r of a text "H/r"; None for other values.

    Raises:
        ValueError: The ratio is not plausible.
    """
    short = isinstance(value, str) and len(value) <= LONGEST
    if not (short and (match := _RULE.fullmatch(value))):
        return None
    if not 1 <= (ratio := float(match[1])) <= 6:
        raise ValueError(
            f"yield_strength: {shown(value)} is not plausible; hardness is 1 to 6 times the yield "
            f'strength, and "H/{FULL_CONSTRAINT}" is usual'
        )
    return ratio


def converted(hardness: Any, ratio: float) -> str:
    """The yield strength as a text; `hardness` is a text, too, or None.

    Raises:
        ValueError: The hardness is missing or wrong.
    """
    if hardness is None:
        raise ValueError(
            f'hardness: is missing; give it, because yield_strength = "H/{ratio:g}" needs it'
        )
    try:
        return f"{read_positive(hardness, 'Pa') / ratio!r} Pa"
    except ValueError as error:
        raise ValueError(f"hardness: {error}") from None


def strength(
    hardness: float, ratio: float, spread: tuple[float, float] | None = None
) -> Property[Any]:
    """The converted yield strength (Pa) with its spread.

    Args:
        hardness: Hardness (Pa).
        ratio: Hardness over yield strength.
        spread: Lowest and highest hardness (Pa), which adds in quadrature to that of the
            conversions.
    """
    value, (low, high) = hardness / ratio, spread or (hardness, hardness)
    less = math.hypot(max(value - hardness / MOST, 0), (hardness - low) / ratio)
    more = math.hypot(max(hardness / LEAST - value, 0), (high - hardness) / ratio)
    return Property[Any](
        value=value,
        low=value - less,
        high=value + more,
        source=f"H/{ratio:g}; usual conversions are H/{MOST:g} to H/{LEAST:g}",
        verified=True,
        conversion=f"H/{ratio:g}",
    )
