"""The keys `size_effect` and `hardness_depth` of a case, and the runs that they change."""

import math
from pathlib import Path

import pytest

from restitution import ConstantBound, ExpandingCavity, SizedBound, run
from restitution.case.case_file import parse_case
from restitution.errors import CaseError
from short_waves import SHORT_WAVES
from tolerance import approx

BODIES = """
first = { material = "steel", radius = "0.5 mm" }
second = { material = "copper", radius = "flat" }
"""
REST = """
[roughness]
kind = "gaussian"
rms = "10 nm"
correlation_length = "2 um"
seed = 1
[grid]
nodes = 48
spacing = "0.4 um"
[impact]
velocity = "0.01 m/s"
[unloading]
curves = 0
"""


def parsed(interface, bodies=BODIES):
    return parse_case(f"{bodies}\n[interface]\n{interface}\n{REST}")


def test_the_models_take_h_star():
    case = parsed('yield_pressure = "0.8 GPa"\nsize_effect = "0.4 um"')
    assert case.yielding().model == SizedBound(0.8e9, 0.4e-6)
    case = parsed('yield_strength = "0.3 GPa"\nsize_effect = "0.4 um"')
    assert case.yielding().model == ExpandingCavity(0.3e9, size_effect=0.4e-6)
    case = parsed('yield_pressure = "0.8 GPa"\nsize_effect = "0 um"')
    assert case.yielding().model == ConstantBound(0.8e9)


def test_the_hardness_of_shallow_indents_is_more_than_that_of_the_bulk():
    keys = 'yield_pressure = "0.8 GPa"\nsize_effect = "0.4 um"\nhardness_depth = "0.2 um"'
    yielding = parsed(keys).yielding()
    assert yielding.hardness == approx(0.8e9 / math.sqrt(3), rel=1e-12)
    assert yielding.model == SizedBound(yielding.hardness, 0.4e-6)


def test_each_of_two_equal_bodies_has_half_of_the_imprint():
    keys = 'yield_pressure = "0.8 GPa"\nsize_effect = "0.4 um"'
    equal = 'first = { material = "copper", radius = "0.5 mm" }\n'
    case = parsed(keys, equal)
    assert case.yielding().size_effect == 0.4e-6
    assert case.yielding().model == SizedBound(0.8e9, 0.2e-6)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (
            'yield_pressure = "elastic"\nsize_effect = "0.4 um"',
            "interface.size_effect: elastic bodies have no hardness; give a yield_pressure",
        ),
        (
            'yield_pressure = "1 GPa"\nplasticity = "truncated"\nsize_effect = "0.4 um"',
            'size_effect: is not defined with plasticity = "truncated"; remove one of them',
        ),
        ('hardness_depth = "1 um"', "hardness_depth: has no effect without size_effect"),
        ('size_effect = "-1 um"', 'interface.size_effect: "-1 um" must not be negative'),
        ("size_effect = 0.4", "interface.size_effect: 0.4 has no unit"),
    ],
)
def test_what_has_no_meaning_is_refused_in_one_line(keys, words):
    with pytest.raises(CaseError) as refused:
        parsed(keys)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_periodic_contact_needs_indentations():
    bodies = BODIES.replace('"0.5 mm"', '"flat"')
    keys = f'{bodies}[interface]\nyield_pressure = "1 GPa"\nsize_effect = "1 um"\n'
    rest = REST.split("[impact]")[0].replace("[grid]", "[grid]\nperiodic = true")
    case = parse_case(f'{keys}{rest}[indentation]\nvalues = ["5 nm"]\n')
    assert case.contact(Path()).plasticity == SizedBound(1e9, 1e-6)
    with pytest.raises(CaseError, match=r"size_effect: .* needs \[indentation\]"):
        parse_case(f'{keys}{rest}[pressure]\nvalues = ["10 MPa"]\n')


def tables(**interface):
    return {
        "total_error": False,
        "first": {"material": "steel", "radius": "0.5 mm"},
        "second": {"material": "copper", "radius": "flat"},
        "interface": {"yield_pressure": "0.8 GPa", **interface},
        "roughness": {
            "kind": "gaussian",
            "rms": "10 nm",
            "correlation_length": "2 um",
            "seed": 1,
        },
        "grid": {"nodes": 64, "spacing": "0.4 um"},
        "impact": {"velocity": "0.01 m/s"},
        "unloading": {"curves": 0},
    }


def test_a_run_stores_h_star_and_returns_more_energy():
    small, none = (run(tables(size_effect=size)) for size in ("3 um", "0 um"))
    assert small.summary["model"]["size_effect_m"] == 3e-6
    assert "size_effect_m" not in none.summary["model"]
    assert small.summary["conventions"] == none.summary["conventions"]
    assert small.curve.restitution[0] > none.curve.restitution[0] + 0.005
    assert none.curve.restitution[0] == run(tables()).curve.restitution[0]


def test_many_impacts_know_h_star():
    runs = []
    for size in ("3 um", "0 um"):
        case = tables(size_effect=size)
        case["impacts"] = {"coverage": 0.3, "places": 2}
        runs.append(run(case).run_in[-1].restitution)
    assert runs[0] > runs[1]


@pytest.mark.filterwarnings("ignore::UserWarning")  # of this coarse grid
@pytest.mark.parametrize("strength", [{}, {"yield_strength": "0.3 GPa", "yield_pressure": None}])
def test_waves_below_the_grid_know_h_star(strength):
    e = []
    for size in ("3 um", "0 um"):
        case = tables(size_effect=size)
        case["interface"] |= strength
        case["interface"] = {key: v for key, v in case["interface"].items() if v is not None}
        case["roughness"] = SHORT_WAVES
        e.append(float(run(case).curve.restitution[0]))
    assert e[0] > e[1] + 0.01
