"""Findings are immutable data."""

import pickle
from dataclasses import FrozenInstanceError

import pytest

from restitution.contact.checks.findings import FewNodes, FinerThanScan

FOUND = FewNodes(1e-7, 1e-6, 8)


def test_a_finding_is_frozen():
    with pytest.raises(FrozenInstanceError):
        FOUND.radius = 2e-6


def test_findings_compare_by_kind_and_values():
    assert FOUND == FewNodes(1e-7, 1e-6, 8) == pickle.loads(pickle.dumps(FOUND))
    assert hash(FOUND) == hash(FewNodes(1e-7, 1e-6, 8))
    assert FewNodes(1e-7, 2e-6, 8) != FOUND
    assert FinerThanScan(1e-7, 1e-6) != FOUND


def test_a_finding_has_a_name_and_says_what_to_do():
    assert FOUND.code == "few-nodes"
    assert "use a finer grid or scan" in FOUND.text()
