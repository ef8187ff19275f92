"""The fraction of each size of a material, by mass or by number."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from restitution.errors import CaseError

KEYS = ("mass_fractions", "number_fractions")
# Largest allowed deviation of the sum of fractions from 1. Given fractions are often rounded.
_OFF = 0.02


def number_fractions(
    key: str, table: dict[str, Any], sizes: object, radii: Sequence[float]
) -> tuple[float, ...]:
    """Remove the fractions from the `table` of a material, and return fractions by number.

    The sum of the result is 1. Without fractions, every size has the same number of particles. All
    sizes have the same density, so a mass fraction is proportional to the number of particles times
    the cube of their radius.

    Args:
        key: Dotted path of the table in the mixture file, for error messages.
        table: Table of the material. The key of the fractions is removed from it.
        sizes: Value of the key `radius`.
        radii: Radii of the sizes (m), in the order of the file.

    Returns:
        Fraction by number of each size, in the order of `radii`.

    Raises:
        CaseError: The fractions are invalid. The message names the key.
    """
    given = [name for name in KEYS if name in table]
    if len(given) > 1:
        raise CaseError(f"{key}: give {KEYS[0]} or {KEYS[1]}, not both")
    if not given:
        return tuple(1 / len(radii) for _ in radii)
    where = f"{key}.{given[0]}"
    if not radii:
        raise CaseError(f"{where}: a wall has no sizes; remove this key")
    if isinstance(sizes, dict) and "median" in sizes:
        raise CaseError(
            f"{where}: the bins of a log-normal distribution always hold equal numbers of "
            "particles; remove this key, or give edges or bins instead of median and geometric_std"
        )
    fractions = _checked(where, table.pop(given[0]), len(radii))
    power = 3 if given[0] == "mass_fractions" else 0
    numbers = [share / R**power for share, R in zip(fractions, radii, strict=True)]
    return tuple(number / math.fsum(numbers) for number in numbers)


def _checked(where: str, values: Any, count: int) -> list[float]:
    if not isinstance(values, list):
        raise CaseError(f"{where}: should be a list with a fraction for each size")
    for value in values:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise CaseError(f"{where}: {value!r} should be a number without a unit, such as 0.25")
        if not 0 < value <= 1:
            raise CaseError(f"{where}: {value:g} should be above 0 and at most 1")
    if len(values) != count:
        raise CaseError(f"{where}: has {len(values)} values for {count} sizes")
    total = math.fsum(values)
    if abs(total - 1) > _OFF:
        raise CaseError(f"{where}: the sum is {total:g}, but should be 1")
    return [float(value) for value in values]
