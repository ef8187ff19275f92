"""The walk from `solve` to the minimisers: no file is entered more than twice on it."""

import sys
from functools import cache
from pathlib import Path

import pytest

import restitution as rs

PACKAGE = Path(rs.__file__).parent
MINIMISERS = {"minimise_quadratic", "minimise_locally"}
STEEL = rs.Body(radius=10e-6, youngs_modulus=210e9, poissons_ratio=0.3)
SOFT = rs.Body(radius=2e-6, youngs_modulus=5e9, poissons_ratio=0.4)
PAIR, ROUGH = rs.Pair(STEEL, STEEL), {"kind": "gaussian", "correlation_length": 0.4e-6, "seed": 5}
SURFACE = rs.generate_surface(rs.Grid((48, 44), (40e-9, 44e-9)), rms=3e-9, **ROUGH)
SMALL = rs.smooth(rs.Grid((40, 36), (4e-9, 4.4e-9)))
CONTACTS = {
    "dry": (rs.Contact(PAIR, SURFACE), 5e-9),
    "growing bound": (rs.Contact(PAIR, SURFACE, plasticity=rs.ExpandingCavity(1e9)), 5e-9),
    "truncated": (rs.Contact(PAIR, SURFACE, plasticity=rs.Truncated(1e9)), 5e-9),
    "JKR": (rs.Contact(PAIR, SURFACE, adhesion=rs.JKRLimit(0.1)), 5e-9),
    "cohesive": (rs.Contact(rs.Pair(SOFT, SOFT), SMALL, adhesion=rs.Cohesive(0.02, 1e-9)), 1e-9),
}


@cache
def name_of(file):
    path = Path(file)
    return path.relative_to(PACKAGE).as_posix() if path.is_relative_to(PACKAGE) else None


def walk_to(frame):
    """The files of this package that lead to `frame`, the first one first, each once in a row."""
    files = []
    while frame is not None:
        name = name_of(frame.f_code.co_filename)
        if name is not None and files[-1:] != [name]:
            files.append(name)
        frame = frame.f_back
    return tuple(reversed(files))


def walks(run):
    """Every walk on which `run` comes to a minimiser."""
    seen = set()

    def note(frame, event, _):
        if event == "call" and frame.f_code.co_name in MINIMISERS:
            seen.add(walk_to(frame))

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        run()
    finally:
        sys.setprofile(before)
    return seen


@pytest.mark.parametrize("name", CONTACTS)
def test_no_file_is_entered_more_than_twice(name):
    contact, depth = CONTACTS[name]
    seen = walks(lambda: rs.solve(contact, depth))
    assert seen
    assert all(walk[:2] == ("arguments.py", "contact/loading.py") for walk in seen)
    assert max(walk.count(file) for walk in seen for file in walk) <= 2
    shortest = min(seen, key=len)
    assert len(set(shortest)) == len(shortest) <= 9
