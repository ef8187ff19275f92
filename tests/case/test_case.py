import math

import numpy as np
import pytest

from restitution.case.case_file import parse_case, read_case
from restitution.case.omissions import default_yield, omissions
from restitution.errors import CaseError
from tolerance import approx


def test_the_second_body_is_the_first_unless_given(case_text):
    pair = parse_case(case_text).pair()
    assert pair.first == pair.second
    assert pair.radius == 250e-6
    assert pair.contact_modulus == approx(112e9)


def test_a_wall_has_no_curvature_and_infinite_mass(case_text):
    wall = '[second]\nradius = "flat"\nyoungs_modulus = "70 GPa"\npoissons_ratio = 0.2\n'
    pair = parse_case(case_text + wall).pair()
    assert pair.radius == 500e-6
    assert pair.mass == approx(4 / 3 * math.pi * 500e-6**3 * 7850)


def test_depths(case_text):
    span = case_text[case_text.index("[indentation]") : case_text.index("[unloading]")]

    def depths(table):
        return parse_case(case_text.replace(span, table)).depths()

    assert depths('[indentation]\nfrom="1 nm"\nto="100 nm"\nsteps=3\n') == approx(
        [1e-9, 1e-8, 1e-7]
    )
    linear = '[indentation]\nfrom="1 nm"\nto="101 nm"\nsteps=3\nscale="linear"\n'
    assert depths(linear) == approx([1e-9, 51e-9, 101e-9])
    assert depths('[indentation]\nvalues=["50 nm", "10 nm", "50 nm"]\n') == approx([10e-9, 50e-9])
    assert depths('[load]\nvalues=["1 N", "0.5 N"]\n') == [0.5, 1.0]
    assert depths('[impact]\nvelocity=["1 m/s", "50 cm/s"]\n') == [0.5, 1.0]
    assert depths('[impact]\nvelocity="1 m/s"\n') == [1.0]
    span_of = '[impact]\nfrom="0.1 m/s"\nto="10 m/s"\nsteps=3\n'
    assert depths(span_of) == approx([0.1, 1.0, 10.0])


def test_bodies_of_unknown_strength_are_elastic_only_when_asked_for(case_text, tmp_path):
    with pytest.raises(CaseError, match=r'or write yield_pressure = "elastic"'):
        parse_case(case_text.replace('yield_pressure = "750 MPa"', ""))
    contact = parse_case(case_text.replace('"750 MPa"', '"elastic"')).contact(tmp_path)
    assert contact.hardness == math.inf


STEEL = 'first = { material = "steel", radius = "500 um" }\n'


def test_a_material_of_known_strength_yields_by_default(case_text, tmp_path):
    """Without [interface] a steel sphere yields: elastic bodies would give COR = 1.0000 ± 0."""
    begin, end = case_text.index("[first]"), case_text.index("[roughness]")
    case = parse_case(STEEL + case_text[end:])
    assert case.yielding().yield_strength == case.first.yield_strength
    assert case.yielding().source.startswith("Y of first (steel)")
    line = default_yield(case.yielding().source)
    assert line.startswith("The contact yields according to Y of first (steel)")
    assert not any("yield_strength" in line for line in omissions(case))  # information, no warning
    assert default_yield(parse_case(case_text).yielding().source) == ""
    assert begin == case_text.index("[first]")


def test_a_fine_powder_is_told_where_adhesion_would_matter(case_text):
    fine = case_text.replace('"500 um"', '"5 um"').replace('"20 nm"', '"1 nm"')
    (line,) = [line for line in omissions(parse_case(fine)) if "work_of_adhesion" in line]
    assert "would change COR of smooth bodies by more than 0.01" in line
    given = fine.replace("[interface]", '[interface]\nwork_of_adhesion = "0 J/m^2"')
    assert not any("work_of_adhesion" in line for line in omissions(parse_case(given)))
    coarse = case_text.replace('"20 nm"', '"200 nm"')
    assert not any("work_of_adhesion" in line for line in omissions(parse_case(coarse)))


def test_the_scan_is_levelled_before_a_part_is_cut_out(case_text, tmp_path):
    x = np.linspace(-1, 1, 80)
    scan = 1e-7 * x[:, None] ** 3 + 0 * x[None, :]
    np.save(tmp_path / "scan.npy", scan)
    begin, end = case_text.index("[roughness]"), case_text.index("[grid]")
    rough = (
        '[roughness]\nkind="measured"\nfile="scan.npy"\nsize=["40 um","48 um"]\ndetrend="tilt"\n'
    )
    surface = parse_case(case_text[:begin] + rough + case_text[end:]).surface(tmp_path)
    # The plane that fits the whole cubic is steeper than the one that fits its middle.
    slope = np.polyfit(surface.grid.x, surface.height[:, 10], 1)[0]
    assert slope == approx(np.polyfit(surface.grid.x, _levelled_cubic(x), 1)[0], rel=1e-2)


def _levelled_cubic(x):
    z = 1e-7 * x**3
    z = z - np.polyval(np.polyfit(x, z, 1), x)
    return z[40 - 36 : 40 + 36]


def test_a_measured_case_without_grid_uses_the_pixels(case_text, tmp_path):
    np.save(tmp_path / "scan.npy", np.zeros((30, 20)))
    begin, end = case_text.index("[roughness]"), case_text.index("[indentation]")
    rough = '[roughness]\nkind="measured"\nfile="scan.npy"\nsize=["15 um","12 um"]\n'
    surface = parse_case(case_text[:begin] + rough + case_text[end:]).surface(tmp_path)
    assert surface.grid.nodes == (30, 20)
    assert surface.grid.spacing == approx((0.5e-6, 0.6e-6))


def test_only_a_measured_case_may_leave_out_the_grid(case_text):
    begin, end = case_text.index("[grid]"), case_text.index("[indentation]")
    with pytest.raises(CaseError, match=r"the table \[grid\] is missing"):
        parse_case(case_text[:begin] + case_text[end:])


def test_read_case_names_the_file(tmp_path, case_text):
    (tmp_path / "bad.toml").write_text(case_text.replace("title", "titel"))
    with pytest.raises(CaseError, match=r"bad\.toml: titel: unknown key; did you mean \"title\""):
        read_case(tmp_path / "bad.toml")


def test_two_tables_of_one_name_are_refused_with_the_way_to_write_them(case_text):
    twice = case_text + '[roughness]\nkind = "gaussian"\n'
    with pytest.raises(CaseError, match=r"begin each of them with \[\[roughness\]\]"):
        parse_case(twice)
