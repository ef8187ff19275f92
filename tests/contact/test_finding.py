"""Findings are immutable data."""

import pickle

import pytest
from restitution.contact.checks.finding import Finding


def test_a_finding_is_frozen():
    values = {"radius": 1e-6}
    found = Finding("few-nodes", values)
    values["radius"] = 2e-6
    assert found["radius"] == 1e-6
    with pytest.raises(TypeError):
        found.values["radius"] = 2e-6


def test_findings_compare_by_code_and_values():
    found = Finding("few-nodes", {"radius": 1e-6})
    assert found == Finding("few-nodes", {"radius": 1e-6}) == pickle.loads(pickle.dumps(found))
    assert hash(found) == hash(Finding("few-nodes", {"radius": 1e-6}))
    assert found != Finding("few-nodes", {"radius": 2e-6})
    assert found != Finding("no-half-space", {"radius": 1e-6})
