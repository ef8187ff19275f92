"""Public objects say what matters in at most three lines, with units and without arrays."""

import math

import pytest

import restitution as rs
from restitution.display import counted, duration, quantity, some_of, with_error, without_numbers
from restitution.results.reader import RunResults

STEEL = rs.Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25, density=7850)
GRID = rs.Grid((64, 48), (0.5e-6, 1e-6))
SURFACE = rs.generate_surface(GRID, kind="gaussian", rms=50e-9, correlation_length=3e-6, seed=1)
CONTACT = rs.Contact(rs.Pair(STEEL, STEEL), SURFACE, plasticity=rs.ConstantBound(750e6))
STATE = rs.solve(CONTACT, indentation=100e-9)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (250e-6, "m", "250 µm"),
        (999.96e-6, "m", "1 mm"),
        (1e-6, "m", "1 µm"),
        (1e-9, "m", "1 nm"),
        (-0.41e-6, "m", "-410 nm"),
        (0.3e-9, "m", "0.3 nm"),
        (210e9, "Pa", "210 GPa"),
        (2.055e-6, "kg", "2.055 mg"),
        (19.6e-12, "m²", "19.6 µm²"),
        (1e-12, "m²", "1 µm²"),
        (0.05, "J/m²", "50 mJ/m²"),
        (1e-20, "J", "1e-05 fJ"),
        (0.0, "N", "0 N"),
        (math.inf, "Pa", "∞ Pa"),
        (math.nan, "N", "unknown"),
        (None, "kg", "unknown"),
    ],
)
def test_quantities_have_the_prefix_that_fits(value, unit, text):
    assert quantity(value, unit) == text


def test_nouns_are_counted():
    assert [counted(n, "node") for n in (0, 1, 2)] == ["0 nodes", "1 node", "2 nodes"]


@pytest.mark.parametrize(
    ("value", "parts"),
    [
        (STEEL, ["Body: R 500 µm, E 210 GPa, ν 0.25, ρ 7850 kg/m³"]),
        (rs.Body(math.inf, 70e9, 0.3), ["Body: flat, E 70 GPa, ν 0.3"]),
        (CONTACT.pair, ["Pair: R* 250 µm, E* 112 GPa, m* 2.055 mg", "second: R 500 µm"]),
        (GRID, ["Grid: 64 × 48 nodes of 500 nm × 1 µm, 32 µm × 48 µm"]),
        (SURFACE, ["Surface: gaussian, Sq 50 nm", "64 × 48 nodes"]),
        (CONTACT, ["yield pressure 750 MPa (equilibrium)", "gaussian, Sq 50 nm; 64 × 48"]),
        (rs.Contact(CONTACT.pair, SURFACE), ["\n  elastic\n"]),
        (
            rs.Contact(
                CONTACT.pair,
                SURFACE,
                plasticity=rs.ExpandingCavity(268e6),
                adhesion=rs.JKRLimit(0.05),
            ),
            ["yield strength 268 MPa (expanding-cavity), work of adhesion 50 mJ/m²"],
        ),
        (STATE, ["indentation 100 nm, force ", " mN", "contact area ", " µm² (", "pJ"]),
        (rs.collide(STATE), [f"COR {rs.collide(STATE).restitution:.4f} at ", " mm/s", "pJ"]),
        (rs.material("304"), ["stainless-steel", "E 193 GPa", "Y 290 MPa", "H 1.65 GPa"]),
    ],
    ids=lambda value: type(value).__name__,
)
def test_objects_say_what_matters(value, parts):
    text = repr(value)
    assert str(value) == text
    for part in parts:
        assert part in text
    assert text.count("\n") < 3
    assert "array" not in text
    assert max(map(len, text.splitlines())) < 120


def test_a_law_says_its_velocities_and_fits(points):
    text = repr(points)
    assert text.startswith("Law: glass (R = 1 mm) and glass (R = 1 mm)\n")
    assert "COR 0.3000 to 0.9500 at 13 velocities, 10 mm/s to 10 m/s" in text
    assert "fits: constant, " in text
    assert text.count("\n") == 2


def test_a_collision_that_sticks_says_so():
    assert repr(rs.Collision(1e-9, -1e-10, 1e-6)).startswith("Collision: sticks, COR 0 at ")


def test_a_notebook_shows_escaped_html():
    marked = rs.Surface(SURFACE.height, GRID, {"source": "<b>scan</b> & co"})
    shown = marked._repr_html_()
    assert shown.startswith("<div><b>Surface</b>: &lt;b&gt;scan&lt;/b&gt; &amp; co, Sq 50 nm<br>")
    assert "\n" not in shown


def test_results_that_cannot_be_read_still_have_a_repr(tmp_path):
    assert "curve.csv: does not exist" in repr(RunResults(tmp_path))


def test_texts_that_differ_in_numbers_only_are_equal_without_them():
    one, other = "3 of 4 depths (up to 1.5e-07 m)", "12 of 40 depths (up to 20.25 m)"
    assert without_numbers(one) == without_numbers(other)
    assert without_numbers(one) != without_numbers(one.replace("depths", "forces"))


def test_some_of_many_names():
    assert some_of(["b", "a", "", "b"]) == "b, a"
    assert some_of("abcde", most=3) == "a, b, c and 2 more"
    assert some_of([]) == ""


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (91.55e-3, 4.849e-3, "91.6 ± 4.8 mN"),
        (588.8e-9, 14.29e-9, "589 ± 14 nN"),
        (137.1e-9, 128e-9, "137 ± 128 nN"),
        (1.234e-3, 1e-5, "1.234 ± 0.010 mN"),
        (1.234e-3, math.nan, "1.234 mN ± unknown"),
        (1.234e-3, 0.0, "1.234 mN"),
    ],
)
def test_an_error_has_two_digits_and_the_prefix_of_its_value(value, error, text):
    assert with_error(value, error, "N") == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.2, "1 s"), (42, "42 s"), (170, "3 min"), (5000, "83 min"), (9000, "2 h")],
)
def test_a_time_is_rounded_for_people(seconds, text):
    assert duration(seconds) == text
