import contextlib
import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from restitution.case.quantities import read_quantity
from tolerance import approx


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("500 um", "m", 500e-6),
        ("0.25µm", "m", 0.25e-6),  # micro sign
        ("0.25 μm", "m", 0.25e-6),  # Greek mu
        ("1e3 nm", "m", 1e-6),
        (".5 mm", "m", 0.5e-3),
        ("100 angstrom", "m", 1e-8),
        ("1 inch", "m", 0.0254),
        ("210 GPa", "Pa", 210e9),
        ("750 N/mm^2", "Pa", 750e6),
        ("1 N·mm^-2", "Pa", 1e6),
        ("7.85 g/cm^3", "kg/m^3", 7850),
        ("7850 kg/m**3", "kg/m^3", 7850),
        ("2 mN", "N", 2e-3),
        ("7.85 g/cm3", "kg/m^3", 7850),
        ("7850 kg/m3", "kg/m^3", 7850),
        ("750 N/mm2", "Pa", 750e6),
        ("1 m3/cm2", "m", 1e4),
    ],
)
def test_units(text, unit, expected):
    assert read_quantity(text, unit) == approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("10 um", "m", "1e-05"),
        ("5 um", "m", "5e-06"),
        ("3.3 um", "m", "3.3e-06"),
        ("7.85 g/cm^3", "kg/m^3", "7850.0"),
        ("68.9 GPa", "Pa", "68900000000.0"),
    ],
)
def test_values_keep_the_digits_of_the_file(text, unit, expected):
    assert repr(read_quantity(text, unit)) == expected


@pytest.mark.parametrize(
    "value",
    [
        "",
        "um",
        "5",
        5,
        5.0,
        True,
        None,
        [1],
        "5 um 6",
        "2 * 3 um",
        "5 um + 1 um",
        "9**99 um",
        "5 um**999999",
        "inf um",
        "nan m",
        "5 __import__",
        "5 um; 1",
        "5 s",
        "5 degC",
    ],
)
def test_what_is_no_length(value):
    with pytest.raises(ValueError, match="write for example"):
        read_quantity(value, "m")


@pytest.mark.parametrize(
    ("text", "unit", "meant"),
    [
        ("210 gpa", "Pa", "GPa"),
        ("5 UM", "m", "um"),
        ("7 G/cm3", "kg/m^3", "g/cm3"),
        ("1 n", "N", "N"),
    ],
)
def test_a_unit_in_the_wrong_case(text, unit, meant):
    with pytest.raises(ValueError, match=rf"did you mean {meant}\?"):
        read_quantity(text, unit)


@given(st.text(max_size=30))
@example("0¼")
@example("1 m⁰")
def test_no_text_does_anything_but_read_or_refuse(text):
    with contextlib.suppress(ValueError):
        assert math.isfinite(read_quantity(text, "m"))


@given(st.floats(1e-300, 1e300))
def test_the_number_survives(number):
    assert read_quantity(f"{number!r} m", "m") == number
