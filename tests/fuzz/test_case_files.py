"""Random case files, valid ones and damaged ones: one plain line, or the surface they describe.

The seed of a case is its number: `made(number)` is its text.
"""

import copy
import random

import numpy as np
import pytest
import tomli_w

from restitution.case.case_file import parse_case
from restitution.case.derived import deepest_indentation, derived_quantities
from restitution.errors import RestitutionError
from restitution.runs.messages import input_warnings, require_possible

CASES = 400
MOST_NODES = 80**2

LENGTHS = ["0.3 nm", "20 nm", "0.25 um", "1 µm", "500 um", "2 mm", "1e-6 m", "10 angstrom"]
WRONG = [
    "",
    " ",
    "5",
    "um",
    "-1 um",
    "0 um",
    "nan um",
    "1e999 um",
    "1e-400 m",
    "5 kg",
    "1 um^2",
    "1 m um",
    "5 " + "(" * 50 + "m",
    "∞ um",
    "٣ um",
    "1 \u202eum",
    "a\nb",
    "\x00",
    "\x1b[31m",
    "x" * 5000,
    " " * 10**4 + "m",
    "9" * 400 + " um",
    "1 m/m*m",
    "1 delta_degC",
    "1 degF",
    "2.8 Y",
    "flat",
    "hardness",
    "steel",
    "../..",
    "/dev/zero",
    "scan.npy",
    "no.npy",
    "/",
    "\ud7ff",
    "auto",
    0,
    1,
    -1,
    2,
    3,
    10**6,
    2**31,
    2**63,
    -(2**63),
    10**40,
    0.5,
    -0.0,
    1e308,
    1e-308,
    float("nan"),
    float("inf"),
    -float("inf"),
    True,
    False,
    [],
    [[]],
    [1, 2, 3],
    ["1 um"],
    ["1 um", "2 um"],
    ["2 um", "1 um", 3],
    {},
    {"x": 1},
    {"a": {"b": {"c": [1]}}},
    [{}],
    [{"kind": 1}],
]


def body(rng):
    table = {"radius": rng.choice(LENGTHS[4:6])}
    if rng.random() < 0.4:
        return {**table, "material": rng.choice(["steel", "glass", "alumina"])}
    return table | {
        "youngs_modulus": rng.choice(["210 GPa", "70 GPa", "3 MPa", "2e11 Pa", "200 kN/mm^2"]),
        "poissons_ratio": rng.choice([0.25, 0.5, 0.0, -0.5, 0.3]),
        "density": rng.choice(["7850 kg/m^3", "2.5 g/cm3"]),
        "yield_strength": "300 MPa",
        "hardness": "1 GPa",
    }


def roughness(rng):
    kind = rng.choice(["gaussian", "exponential", "self-affine", "measured", "measured"])
    if kind == "measured":
        table = {"kind": kind, "file": rng.choice(["scan.npy", "scan.txt"]), "size": "12 um"}
        for key, values in (
            ("detrend", ["none", "tilt", "curvature"]),
            ("outliers", [6.0, 8]),
            ("crop", [{"x": ["-2 um", "3 um"]}]),
            ("undefined", ["interpolate"]),
            ("channel", [0]),
        ):
            if rng.random() < 0.2:
                table[key] = rng.choice(values)
        extend = rng.choice([None, "twin", "mirror"])
        if extend:
            table["extend"] = extend
        if extend == "twin":
            table["seed"] = rng.randrange(10)
        return table
    table = {"kind": kind, "rms": rng.choice(LENGTHS[:3]), "seed": rng.randrange(2**63)}
    own = [("lay", ["30 deg", "1 rad"])]
    if kind == "self-affine":
        table["hurst"] = rng.choice([0.3, 0.8, 1.0])
        own = [("rolloff", ["4 um"])]
    else:
        table["correlation_length"] = rng.choice(["1 um", "1.5 um", ["1.8 um", "1 um"]])
    for key, values in (
        *own,
        ("shortest", ["1 um", "0.8 um"]),
        ("skewness", [0.1, -1, 1.5]),
        ("kurtosis", [3.5, 6]),
        ("periodic", [False]),
        ("realisations", [1, 3]),
    ):
        if rng.random() < 0.15:
            table[key] = rng.choice(values)
    return table


def valid(rng):
    """The tables of a case that is mostly valid."""
    case = {"title": "fuzz", "first": body(rng)}
    if rng.random() < 0.4:
        case["second"] = rng.choice([body(rng), "steel"])
    if rng.random() < 0.7:
        case["interface"] = {
            "yield_pressure": rng.choice(["750 MPa", "2.8 Y", "hardness"]),
            "work_of_adhesion": rng.choice(["0 J/m^2", "50 mJ/m^2"]),
            "plasticity": rng.choice(["equilibrium", "truncated"]),
        }
    if rng.random() < 0.8:
        case["roughness"] = rng.choice([roughness(rng), [roughness(rng), roughness(rng)]])
    if rng.random() < 0.95:
        case["grid"] = {
            "nodes": rng.choice([16, 31, [24, 20], 24, [16, 40], 1]),
            "spacing": rng.choice(["0.25 um", "0.3 um", ["0.2 um", "0.4 um"]]),
            "refine": rng.choice([1, 1, 1, 2, "auto"]),
        }
    case |= rng.choice(
        [
            {"indentation": {"from": "20 nm", "to": "300 nm", "steps": 4}},
            {"indentation": {"values": ["10 nm", "1 um"]}},
            {"load": {"values": ["1 mN", "0.1 N"]}},
            {"impact": {"velocity": ["0.1 m/s", "2 m/s"]}},
            {"impact": {"from": "0.1 m/s", "to": "2 m/s", "steps": 3, "scale": "linear"}},
        ]
    )
    if rng.random() < 0.3:
        case["unloading"] = {"curves": 1, "steps": 8}
    return case


def places(table, path=()):
    """Paths to everything that a table holds."""
    items = table.items() if isinstance(table, dict) else enumerate(table)
    for key, value in items:
        yield (*path, key)
        if isinstance(value, (dict, list)):
            yield from places(value, (*path, key))


def damage(rng, case):
    """One value, key or table is changed, moved, doubled or taken away."""
    path = rng.choice(list(places(case)))
    holder = case
    for key in path[:-1]:
        holder = holder[key]
    key, how = path[-1], rng.randrange(6)
    if how == 0:
        del holder[key]
    elif how == 1 and isinstance(holder, dict):
        holder[rng.choice([f"{key}s", key[::-1], "kind", "", "a b", "é\n", "x" * 300])] = holder[
            key
        ]
    elif how == 2:
        holder[key] = [copy.deepcopy(holder[key]) for _ in range(rng.randrange(4))]
    elif how == 3:
        for _ in range(rng.choice([1, 5, 40])):
            holder[key] = {"a": holder[key]}
    elif how == 4 and isinstance(holder[key], str) and holder[key]:
        at, old = rng.randrange(len(holder[key])), holder[key]
        holder[key] = old[:at] + rng.choice(" ^*/e-µ9") + old[at + rng.randrange(3) :]
    else:
        holder[key] = copy.deepcopy(rng.choice(WRONG))


def spoil(rng, text):
    """The text is cut, or some of its characters and lines are."""
    how = rng.randrange(4)
    if how == 0:
        return text[: rng.randrange(len(text))]
    if how == 1:
        lines = text.splitlines(keepends=True)
        rng.shuffle(lines)
        return "".join(lines)
    letters = list(text)
    for _ in range(rng.choice([1, 3, 30])):
        letters[rng.randrange(len(letters))] = rng.choice('"[]{}=.,#\n\\ 0aé\x00')
    return "".join(letters)


def made(number):
    """The text of case `number`: valid, damaged in its tables, or spoilt as a text."""
    rng = random.Random(number)
    case = valid(rng)
    for _ in range(rng.choice([0, 0, 1, 1, 1, 2, 4])):
        if case:
            damage(rng, case)
    try:
        text = tomli_w.dumps(case)
    except (TypeError, ValueError, UnicodeError):
        text = tomli_w.dumps(valid(rng))
    return spoil(rng, text) if rng.random() < 0.15 else text


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scans")
    height = 2e-8 * np.random.default_rng(1).standard_normal((40, 40)).cumsum(axis=0)
    np.save(folder / "scan.npy", height)
    np.savetxt(folder / "scan.txt", height)
    return folder


def use(text, folder):
    """Everything that `check` does with a case on a small grid."""
    case = parse_case(text)
    if case.grid is not None and case.grid.nodes is not None:
        nx, ny = case.grid.nodes
        if nx * ny * case.grid.factor**2 > MOST_NODES:
            return "large"
    contact = case.contact(folder)
    assert np.isfinite(contact.surface.height).all()
    deepest = deepest_indentation(case)
    derived_quantities(case, contact)
    require_possible(contact, deepest)
    for line in input_warnings(contact, deepest):
        assert line
    return "valid"


def test_case_files(fuzz, folder, within, plainly_refused):
    parse_case(tomli_w.dumps(valid(random.Random(0))))  # the table of units is read once
    ends = {"valid": 0, "large": 0, "refused": 0}
    for number in range(round(CASES * fuzz)):
        text = made(number)
        try:
            with within(5):
                end = use(text, folder)
        except RestitutionError as error:
            end = "refused" if plainly_refused(error) else str(error)
        except Exception as error:
            raise AssertionError(f"case {number}: {error!r}"[:1000]) from error
        assert end in ends, (number, end[:1000])
        ends[end] += 1
    print(ends)
    assert ends["valid"] > 0.1 * sum(ends.values()) < ends["refused"]
