"""Confidence intervals of means."""

from __future__ import annotations

import math

CONFIDENCE = 0.95  # level of the interval of a mean


def half_interval(n: int) -> float:
    """Half of the 95 % interval of a mean of n values, in their standard deviation; NaN for one.

    Student's t/√n.
    """
    # stdtrit is the quantile of Student's t. Importing scipy.stats would take 30 MB more memory.
    from scipy.special import stdtrit

    return float(stdtrit(n - 1, 0.5 * (1 + CONFIDENCE))) / math.sqrt(n)
