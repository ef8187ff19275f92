"""The words that `restitution run` adds to its numbers."""

import math

from points import point
from restitution.cli.run import _elastic_error, _with_error


def test_the_error_of_a_model_that_does_not_yield_is_explained():
    def row(error, work, cor):
        return point(model_error=error, plastic_work=work, restitution=cor)

    assert "from 1.6 Y on" in _elastic_error([row(0.0, 0.0, 1.0), row(0.07, 0.0, 1.0)])
    for other in (row(0.0, 0.0, 1.0), row(0.1, 1e-9, 0.9), row(0.1, 0.0, 0.9)):
        assert _elastic_error([other]) == ""


def test_unknown_errors_are_named():
    assert _with_error(0.5, 0.01, wanted=True) == "0.5000 ± 0.0100"
    assert _with_error(0.5, math.nan, wanted=True) == "0.5000 ± unknown"
    assert _with_error(0.5, math.nan, wanted=False) == "0.5000"
