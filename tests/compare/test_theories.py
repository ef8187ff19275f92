"""Tables of theories: values equal those of the theory's module, and are NaN outside its range."""

import csv
import math

import numpy as np
import pytest

from restitution import theory
from restitution.case.derived import derived_quantities
from restitution.compare import theories as room
from restitution.errors import CaseError, OutputError
from restitution.theory import (
    JKR,
    MDR,
    AdhesiveThorntonNing,
    FirstYield,
    Hertz,
    Johnson,
    ThorntonNing,
)
from theory_cases import ELASTIC, LIGHT, PLASTIC, SPHERE, WALL, YIELDING, V, by_name, case_of
from tolerance import approx


def bodies(case):
    pair = case.pair()
    return pair.radius, pair.contact_modulus, pair.mass


def same_within(found, expected, inside):
    """Check for the module's values where `inside` and NaN elsewhere; both must occur."""
    assert 0 < inside.sum() < inside.size
    np.testing.assert_allclose(found[inside], expected[inside], rtol=1e-12)
    assert np.isnan(found[~inside]).all()


def test_a_sphere_on_a_wall_has_every_theory():
    assert set(by_name(case_of(second=WALL))) == {"hertz", *YIELDING}
    with_adhesion = case_of(second=WALL, interface=PLASTIC + 'work_of_adhesion = "0.1 J/m^2"\n')
    assert set(by_name(with_adhesion)) == {"hertz", "sticking", *YIELDING}


def test_hertz_loses_nothing_until_something_yields():
    case = case_of(second=WALL)
    R, E, m = bodies(case)
    V_y = FirstYield(R, E, 560e6).velocity(m)
    same_within(by_name(case)["hertz"].restitution, np.ones_like(V), V_y >= V)


def test_hertz_and_check_use_the_same_yield_velocity(tmp_path):
    case = case_of(interface='yield_strength = "200 MPa"\n')
    V_y = derived_quantities(case, case.contact(tmp_path))["yield_velocity_m_per_s"]
    assert room.marks(case)["V_y"] == approx(V_y, rel=1e-12)
    V = np.array([0.999, 1.001]) * V_y
    (hertz,) = (each for each in room.theories(case, V) if each.name == "hertz")
    assert hertz.restitution[0] == 1
    assert np.isnan(hertz.restitution[1])
    p_y = hertz.parameters["yield_pressure_Pa"]
    assert FirstYield(*bodies(case)[:2], p_y).velocity(bodies(case)[2]) == approx(V_y, rel=1e-12)


def test_hertz_ends_where_the_contact_is_no_longer_small():
    case = case_of(interface=ELASTIC)
    R, E, m = bodies(case)
    limit = math.sqrt(2 * Hertz(R, E).stored_energy(0.01 * R) / m)
    found = by_name(case)["hertz"]
    same_within(found.restitution, np.ones_like(V), limit >= V)
    assert f"{limit:.3g} m/s (indentation 0.01 R*)" in found.holds


def test_smooth_bodies_with_a_size_effect_are_those_of_a_higher_pressure():
    sized = 'yield_pressure = "560 MPa"\nsize_effect = "1 um"\n'
    R, _, _ = bodies(case_of(second=WALL))
    harder = math.sqrt(1 + 1e-6 / (1.5 * 0.358**2 * R))
    equal = f'yield_pressure = "{560e6 * harder!r} Pa"\n'
    found, expected = (by_name(case_of(second=WALL, interface=i)) for i in (sized, equal))
    for name in ("hertz", "thornton-ning"):
        assert found[name].parameters == approx(expected[name].parameters, rel=1e-12)
        inside = np.isfinite(expected[name].restitution)
        assert np.array_equal(np.isfinite(found[name].restitution), inside)
        same = expected[name].restitution[inside]
        assert found[name].restitution[inside] == approx(same, rel=1e-9)


def test_thornton_ning_takes_the_pressure_of_the_case():
    case = case_of(second=WALL)
    R, E, m = bodies(case)
    depth = ThorntonNing(R, E, 560e6).indentation_from_velocity(V, m)
    expected = ThorntonNing(R, E, 560e6).restitution(V, m)
    found = by_name(case)["thornton-ning"]
    assert found.parameters == {"yield_pressure_Pa": approx(560e6)}
    same_within(found.restitution, expected, depth < R)


def test_johnson_answers_only_in_fully_plastic_impacts():
    case = case_of(second=WALL)
    R, E, m = bodies(case)
    expected = Johnson(R, E, 200e6).restitution(V, m)
    small = 0.5 * m * V**2 < 0.75 * np.pi * 200e6 * R**3
    found = by_name(case)["johnson"]
    same_within(found.restitution, expected, (expected < 0.6) & small)
    assert "Y = p_y/2.8 = 200 MPa" in found.holds
    lowest = float(found.holds.split("above ")[1].split(" m/s")[0])
    assert Johnson(R, E, 200e6).restitution(lowest, m) == approx(0.6, rel=2e-3)
    highest = float(found.holds.split("no value above ")[1].split(" m/s")[0])
    assert highest == approx(V[small][-1], rel=0.1)


def test_mdr_on_a_wall_and_between_equal_spheres():
    case = case_of(second=WALL)
    R, E, m = bodies(case)
    expected = MDR(R, E * (1 - 0.25**2), 0.25, 200e6).restitution(V, m)
    same_within(by_name(case)["mdr"].restitution, expected, np.isfinite(expected))

    equal = case_of()
    found = by_name(equal)["mdr"]
    expected = MDR(1e-3, 70e9, 0.25, 200e6).restitution(V / 2, 2 * bodies(equal)[2])
    same_within(found.restitution, expected, np.isfinite(expected))
    last = float(found.holds.split("up to ")[1].split(" m/s")[0])
    assert last == approx(V[np.isfinite(expected)][-1], rel=0.1)


def test_two_equal_spheres_are_one_on_a_rigid_wall_at_half_the_velocity():
    equal = by_name(case_of())
    rigid = case_of(second=WALL.replace("200 GPa", "900000 GPa"))
    wall = by_name(rigid, V / 2)
    np.testing.assert_allclose(equal["mdr"].restitution, wall["mdr"].restitution, rtol=1e-3)


def test_unequal_spheres_are_left_out_where_a_theory_knows_equal_ones_only():
    case = case_of(second=SPHERE.replace("1 mm", "2 mm") + LIGHT)
    assert set(by_name(case)) == {"hertz"} | YIELDING - {"mdr"}
    assert "equal" in room.left_out(case)["mdr"]
    R, E, m = bodies(case)
    expected = ThorntonNing(R, E, 560e6).restitution(1.0, m)
    (found,) = by_name(case, np.ones(1))["thornton-ning"].restitution
    assert found == approx(expected, rel=1e-12)


def test_the_yield_strength_is_the_softer_bodys_where_both_give_one():
    strong = 'yield_strength = "400 MPa"\n'
    weak = 'yield_strength = "150 MPa"\n'
    soft_sphere = case_of(first=SPHERE + LIGHT + weak, second=WALL + strong)
    found = by_name(soft_sphere)
    for name in ("johnson", "mdr"):
        assert found[name].parameters["yield_strength_Pa"] == approx(150e6)
        assert "Y = 150 MPa, the yield_strength of first" in found[name].holds
    assert found["thornton-ning"].parameters == {"yield_pressure_Pa": approx(560e6)}

    soft_wall = case_of(first=SPHERE + LIGHT + strong, second=WALL + weak)
    assert "assumes a rigid wall" in room.left_out(soft_wall)["mdr"]

    one = by_name(case_of(first=SPHERE + LIGHT + weak, second=WALL))
    assert one["johnson"].parameters["yield_strength_Pa"] == approx(200e6)


def test_spheres_are_equal_only_if_their_yield_strengths_are():
    sphere = SPHERE + LIGHT + 'yield_strength = "{} MPa"\n'
    equal = case_of(first=sphere.format(150), second=sphere.format(150.0))
    assert by_name(equal)["mdr"].parameters["yield_strength_Pa"] == approx(150e6)
    unlike = case_of(first=sphere.format(150), second=sphere.format(160))
    assert "needs equal spheres" in room.left_out(unlike)["mdr"]


@pytest.mark.parametrize("wall_first", [False, True])
def test_the_order_of_the_bodies_does_not_matter(wall_first):
    strong, weak = SPHERE + LIGHT + 'yield_strength = "400 MPa"\n', WALL
    weak += 'yield_strength = "150 MPa"\n'
    case = case_of(weak, strong) if wall_first else case_of(strong, weak)
    assert "mdr" in room.left_out(case)


def test_adhesion_adds_its_loss_to_thornton_ning_and_is_said_to_be_left_out_elsewhere():
    case = case_of(second=WALL, interface=PLASTIC + 'work_of_adhesion = "0.1 J/m^2"\n')
    R, E, m = bodies(case)
    V_s, V_y = room.marks(case)["V_s"], room.marks(case)["V_y"]
    assert V_s == approx(JKR(R, E, 0.1).sticking_velocity(m))
    found = by_name(case)
    elastic = JKR(R, E, 0.1).restitution(V, m)
    same_within(found["sticking"].restitution, elastic, V_y >= V)
    depth = ThorntonNing(R, E, 560e6).indentation_from_velocity(V, m)
    expected = AdhesiveThorntonNing(R, E, 560e6, 0.1).restitution(V, m)
    same_within(found["thornton-ning"].restitution, expected, depth < R)
    for name, each in found.items():
        assert ("without the adhesion of this pair" in each.holds) == (
            name not in ("sticking", "thornton-ning")
        )
    assert "Tabor parameter above 5" in found["sticking"].holds


def test_a_pair_that_yields_before_it_can_rebound_has_no_adhesive_answer_above():
    case = case_of(second=WALL, interface=PLASTIC + 'work_of_adhesion = "50 J/m^2"\n')
    V_s, V_y = room.marks(case)["V_s"], room.marks(case)["V_y"]
    assert V_s > V_y
    found = by_name(case)
    assert np.isnan(found["sticking"].restitution).all()
    assert "at no velocity here" in found["sticking"].holds
    same_within(found["thornton-ning"].restitution, np.zeros_like(V), V_y >= V)


def test_an_elastic_case_has_hertz_and_with_adhesion_sticking():
    assert set(by_name(case_of(interface=ELASTIC))) == {"hertz"}
    assert set(room.left_out(case_of(interface=ELASTIC))) == {"sticking", *YIELDING}
    sticky = case_of(interface=ELASTIC + 'work_of_adhesion = "0.1 J/m^2"\n')
    found = by_name(sticky)
    assert set(found) == {"hertz", "sticking"}
    assert np.nanmin(found["sticking"].restitution) == 0
    assert set(room.marks(sticky)) == {"V_s"}


@pytest.mark.parametrize(
    ("interface", "marked"),
    [
        (ELASTIC, set()),
        (PLASTIC, {"V_y"}),
        (PLASTIC + 'work_of_adhesion = "0.1 J/m^2"\n', {"V_y", "V_s"}),
    ],
)
def test_velocities_that_do_not_exist_are_not_marked(interface, marked):
    assert set(room.marks(case_of(interface=interface))) == marked


def test_no_theory_rests_on_constants_that_nobody_could_look_up():
    """The constants of Wu, Li and Thornton have no source, and finite elements contradict them."""
    assert not [name for name in room.FORMS if name.startswith("wu")]
    assert not hasattr(theory, "wu_li_thornton")


def test_velocities_are_the_span_of_the_case():
    V = room.velocities_of(case_of())
    assert approx(np.geomspace(1e-3, 100, 25)) == V

    case = case_of(depths='[indentation]\nfrom = "10 nm"\nto = "5 um"\nsteps = 4\n')
    R, E, m = bodies(case)
    V = room.velocities_of(case)
    assert V.size == 25
    assert V[[0, -1]] == approx(
        ThorntonNing(R, E, 560e6).impact_velocity(np.array([1e-8, 5e-6]), m)
    )


def test_velocities_of_loads_are_those_of_the_smooth_bodies_that_carry_them():
    case = case_of(depths='[load]\nfrom = "1 mN"\nto = "50 N"\nsteps = 4\n')
    R, E, m = bodies(case)
    depth = ThorntonNing(R, E, 560e6).indentation_from_velocity(room.velocities_of(case), m)
    force = ThorntonNing(R, E, 560e6).loading_force(depth[[0, -1]])
    assert force == approx([1e-3, 50])

    elastic = case_of(interface=ELASTIC, depths='[load]\nfrom = "1 mN"\nto = "50 N"\nsteps = 4\n')
    work = 0.5 * m * room.velocities_of(elastic)[-1] ** 2
    assert work == approx(Hertz(R, E).stored_energy(Hertz(R, E).indentation(50)))


def test_a_single_depth_is_a_single_velocity():
    case = case_of(depths='[impact]\nvelocity = ["2 m/s"]\n')
    assert room.velocities_of(case).tolist() == [2.0]


def test_a_case_without_density_is_refused():
    depths = '[indentation]\nvalues = ["10 nm"]\n'
    with pytest.raises(CaseError, match=r"^first\.density: is missing"):
        room.velocities_of(case_of(first=SPHERE, depths=depths))
    with pytest.raises(CaseError, match=r"^second\.density: is missing"):
        room.theories(case_of(second=SPHERE, depths=depths), V)


def test_the_table(points, tmp_path):
    case = case_of()
    V = room.velocities_of(case, points)
    found = room.theories(case, V, points)
    path = room.write_theories(V, found, tmp_path / "out")
    assert path == tmp_path / "out" / "theory.csv"
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["velocity_m_per_s", *(each.name for each in found)]
    for each in found:
        column = [float(row[each.name] or "nan") for row in rows]
        np.testing.assert_array_equal(column, each.restitution)
    assert rows[0]["johnson"] == ""
    with pytest.raises(OutputError, match="not empty"):
        room.write_theories(V, found, tmp_path / "out")


def test_the_softer_body_gives_its_name_whichever_it_is():
    soft, hard = (f'yield_strength = "{Y} MPa"\n' for Y in (150, 400))
    for first, second, name in ((soft, hard, "first"), (hard, soft, "second")):
        case = case_of(first=SPHERE + LIGHT + first, second=SPHERE + LIGHT + second)
        assert f"Y = 150 MPa, the yield_strength of {name}" in by_name(case)["johnson"].holds


def test_a_small_tabor_parameter_is_said_to_lower_the_sticking_velocity():
    bare = case_of(interface=ELASTIC + 'work_of_adhesion = "1 J/m^2"\n')
    R, E, _ = bodies(bare)
    z0 = bare.interface.equilibrium_separation
    for mu, lower in ((4.9, True), (5.1, False)):
        w = math.sqrt(mu**3 * E**2 * z0**3 / R)
        case = case_of(interface=ELASTIC + f'work_of_adhesion = "{w!r} J/m^2"\n')
        said = by_name(case)["sticking"].holds
        assert f"here {mu:.2g}" in said
        assert ("so the true V_s is lower" in said) == lower


def test_a_negative_poissons_ratio_leaves_mdr_out_and_zero_does_not():
    for nu, left in ((-0.1, True), (0.0, False)):
        case = case_of(first=SPHERE.replace("0.25", str(nu)) + LIGHT, second=WALL)
        assert ("mdr" in room.left_out(case)) == left
        assert ("mdr" in by_name(case)) != left


def test_mdr_takes_the_poissons_ratio_of_the_sphere_in_either_order():
    V = np.array([0.1, 1.0])
    one, other = (by_name(case_of(*pair), V)["mdr"] for pair in PAIRS)
    assert one.parameters["poissons_ratio"] == other.parameters["poissons_ratio"] == 0.25
    assert one.restitution.tolist() == approx(other.restitution.tolist())


PAIRS = ((SPHERE + LIGHT, WALL), (WALL, SPHERE + LIGHT))


@pytest.mark.parametrize("second", [WALL, None])
@pytest.mark.parametrize("name", ["mdr", "johnson", "thornton-ning"])
def test_the_end_of_a_theory_that_is_said_is_the_one_of_its_values(name, second):
    case = case_of(second=second)
    holds = by_name(case)[name].holds
    last = float(holds.split("up to " if name == "mdr" else "no value above ")[-1].split(" m/s")[0])
    below, above = by_name(case, last * np.array([0.99, 1.01]))[name].restitution
    assert np.isfinite(below)
    assert np.isnan(above)


def test_johnsons_range_may_be_empty():
    hard = case_of(second=WALL, interface='yield_pressure = "60 GPa"\n')
    found = by_name(hard)["johnson"]
    assert "so at no velocity here" in found.holds
    assert np.isnan(found.restitution).all()
    assert "at no velocity" not in by_name(case_of(second=WALL))["johnson"].holds


def test_the_largest_contact_is_that_of_the_velocities_asked_for():
    case = case_of(second=WALL)
    R, E, m = bodies(case)
    V = np.array([0.1, 3.0])
    a = math.sqrt(ThorntonNing(R, E, 560e6).indentation_from_velocity(3.0, m) / R)
    assert f"here a/R* up to {a:.2g};" in by_name(case, V)["thornton-ning"].holds
