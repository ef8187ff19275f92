"""Executors of cases: the errors for the user."""

import sys

import pytest

from restitution.errors import OutputError
from restitution.sweeps.executors import cluster_workers


def test_without_dask_the_extra_is_named_as_pip_takes_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(OutputError, match=r'^scheduler: Dask .* `pip install "\.\[cluster\]"` in'):
        cluster_workers("tcp://127.0.0.1:1").__enter__()
