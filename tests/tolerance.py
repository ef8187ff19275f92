"""Comparing numbers of any size: energies here are nanojoules."""

import pytest


def approx(expected, rel=None, abs=None):
    """`pytest.approx` without its absolute tolerance of 1e-12, which hides what is smaller.

    Within 1e-6 of the number unless `rel` or `abs` is given. A zero needs an `abs` that says how
    small is small enough.
    """
    if abs is None:
        rel, abs = 1e-6 if rel is None else rel, 0.0
    return pytest.approx(expected, rel=rel, abs=abs)  # noqa: TID251
