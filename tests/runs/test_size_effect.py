"""A run says what it leaves out if the library knows h* and the case does not give it."""

import re

import pytest

from restitution import run
from short_waves import SHORT_WAVES
from tolerance import approx

CASE = {
    "first": {"material": "copper", "radius": "0.5 mm"},
    "second": {"material": "steel", "radius": "flat"},
    "interface": {"work_of_adhesion": "0 J/m^2"},
    "roughness": {"kind": "gaussian", "rms": "40 nm", "correlation_length": "1 um", "seed": 1},
    "grid": {"nodes": 64, "spacing": "0.2 um"},
    "impact": {"velocity": "1 mm/s"},
    "unloading": {"curves": 0},
}
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")  # of this coarse grid
TEXT = re.compile(
    r"the asperities that yield are as sharp as Berkovich indents of (\d+\.?\d*) nm, and copper is "
    r"harder below h\* = 464 nm: COR would be about (0\.\d+) instead of (0\.\d+) at 1 mm/s; "
    r'set interface\.size_effect = "0\.464 um", or "0 um" without this effect'
)


def sharp(results):
    return [warning for warning in results.summary["warnings"] if "sharp" in warning]


def test_the_size_effect_that_is_left_out_is_estimated():
    results = run(CASE)
    (said,) = sharp(results)
    depth, harder, own = map(float, TEXT.fullmatch(said).groups())
    assert 100 < depth < 464
    assert own == approx(results.curve.restitution[0], rel=0.02)
    given = run(
        {
            **CASE,
            "interface": {**CASE["interface"], "size_effect": "0.464 um"},
            "total_error": False,
        }
    )
    change = given.curve.restitution[0] - results.curve.restitution[0]
    assert harder - own == approx(change, rel=0.5)


@pytest.mark.parametrize("given", ["0 um", "0.464 um"])
def test_a_given_key_is_no_reason_to_warn(given):
    results = run({**CASE, "interface": {**CASE["interface"], "size_effect": given}})
    assert sharp(results) == []


def test_patches_of_short_waves_count_in_what_is_left_out():
    """Copper whose waves below the grid are in patches, without and with the key."""
    case = {
        **CASE,
        "roughness": SHORT_WAVES,
        "grid": {"nodes": 64, "spacing": "0.4 um"},
        "impact": {"velocity": "20 mm/s"},
    }
    assert run({**case, "total_error": False}).summary["status"] == "complete"
    given = {**case["interface"], "size_effect": "0.464 um"}
    harder, off = (
        run({**case, "interface": {**given, "size_effect": size}, "total_error": False})
        for size in ("0.464 um", "0 um")
    )
    assert harder.curve.points[0].model_error > off.curve.points[0].model_error + 0.005
