"""Theories beside a law: its points, the force laws fitted to it, and Brilliantov's fit."""

from dataclasses import replace

import numpy as np
import pytest

from restitution.compare import theories as room
from restitution.dem.fits import fitted_laws
from restitution.errors import CaseError
from restitution.laws.particle import Particle
from restitution.theory import Brilliantov
from theory_cases import ELASTIC, V, by_name, case_of
from tolerance import approx


def test_a_law_adds_its_points_and_what_is_fitted_to_them(points):
    case = case_of()
    V = room.velocities_of(case, points)
    assert V.tolist() == points.column("velocity").tolist()
    found = by_name(case, V, points)
    new = ("computed", "constant", "walton-braun", "luding", "eepa", "brilliantov")
    assert tuple(found)[-6:] == new
    assert found["computed"].restitution.tolist() == points.column("restitution").tolist()
    for each in points.laws:
        if each.name in new:
            assert found[each.name].restitution.tolist() == list(each.restitution)
            assert found[each.name].parameters == each.parameters


def test_brilliantov_is_the_best_there_is(points):
    V, e = points.column("velocity"), points.column("restitution")
    found = by_name(case_of(), V, points)["brilliantov"]
    (beta,) = found.parameters.values()
    assert found.restitution.tolist() == Brilliantov(beta).restitution(V).tolist()

    def misfit(beta):
        return np.sum((Brilliantov(beta).restitution(V) - e) ** 2)

    assert misfit(beta) <= min(map(misfit, beta * np.geomspace(1e-6, 1e6, 2001)))


def test_brilliantov_is_found_again(law):
    V = law().column("velocity")
    e = Brilliantov(0.3).restitution(V)
    exact = law(
        points=tuple(
            replace(point, restitution=float(value), ratio=float(value) ** 2)
            for point, value in zip(law().points, e, strict=True)
        )
    )
    found = by_name(case_of(), V, exact)["brilliantov"]
    assert found.parameters["dissipation_s_per_m_power_1_5"] == approx(0.3, rel=1e-6)


def test_nothing_of_a_law_is_interpolated(points):
    found = by_name(case_of(), np.array([0.02, *points.column("velocity")[:2]]), points)
    for name in ("computed", "constant", "luding", "brilliantov"):
        assert np.isnan(found[name].restitution).tolist() == [True, False, False]


def test_what_is_fitted_to_a_law_is_empty_where_the_law_is_not_resolved(law):
    ends = (0, 1, 12)
    coarse = tuple(replace(point, resolved=k not in ends) for k, point in enumerate(law().points))
    found = law(points=coarse, yield_pressure=560e6)
    found = replace(found, laws=fitted_laws(found))
    V = found.column("velocity")
    beside = by_name(case_of(), V, found)
    for name in ("constant", "walton-braun", "luding", "eepa", "brilliantov"):
        empty = np.flatnonzero(np.isnan(beside[name].restitution))
        assert tuple(empty) == ends, name
        assert "from 0.0316 to 5.62 m/s" in beside[name].holds
    assert not np.isnan(beside["computed"].restitution).any()


def test_a_law_that_loses_nothing_has_nothing_to_fit(law):
    lossless = tuple(replace(point, restitution=1.0, ratio=1.0) for point in law().points)
    elastic = law(points=lossless, yield_pressure=None)
    case = case_of(interface=ELASTIC)
    assert list(by_name(case, V, elastic)) == ["hertz", "computed"]
    assert "e = 1 at every velocity" in room.left_out(case, elastic)["brilliantov"]


def test_a_law_of_another_pair_is_refused(law):
    steel = Particle(
        name="steel", radius=1e-3, youngs_modulus=200e9, poissons_ratio=0.3, density=7800.0
    )
    with pytest.raises(CaseError, match=r"its E\* is .* Pa \(.* in the case\), its m\* is") as said:
        room.theories(case_of(), V, law(steel, steel))
    assert "R*" not in str(said.value)
    room.check_same_pair(case_of(), law(mass=law().mass * (1 + 5e-7)))
    with pytest.raises(CaseError, match=r"m\*"):
        room.check_same_pair(case_of(), law(mass=law().mass * (1 + 2e-6)))


def test_a_law_with_another_interface_says_so(points, law):
    assert "another interface" not in by_name(case_of(), V, points)["computed"].holds
    other = law(yield_pressure=2e9, work_of_adhesion=0.3)
    said = by_name(case_of(), V, other)["computed"].holds
    assert "p_y = 2 GPa, w = 0.3 J/m^2" in said


@pytest.mark.parametrize("p_y", [None, 2e9])
@pytest.mark.parametrize("w", [0.0, 0.3])
def test_the_computed_points_state_the_interface_of_their_law(law, p_y, w):
    stated = {"yield_pressure_Pa": p_y, "work_of_adhesion_J_per_m2": w or None}
    found = by_name(case_of(), V, law(yield_pressure=p_y, work_of_adhesion=w))["computed"]
    assert found.parameters == {name: value for name, value in stated.items() if value}


def test_nothing_is_fitted_to_what_is_not_resolved(law):
    coarse = tuple(replace(point, resolved=False) for point in law().points)
    found = law(points=coarse)
    assert "brilliantov" not in by_name(case_of(), V, found)
    assert (
        "the grid resolves no velocity of the law" in room.left_out(case_of(), found)["brilliantov"]
    )


def test_with_a_constant_alone_the_other_fits_are_left_out(law):
    stuck = tuple(replace(point, restitution=0.0, ratio=-0.1) for point in law().points)
    found = law(points=stuck, work_of_adhesion=0.1)
    found = replace(found, laws=fitted_laws(found))
    reasons = room.left_out(case_of(), found)
    assert [name for name in room._FITTED if name not in reasons] == ["constant"]
    assert "e = 0 at every velocity of the law" in reasons["brilliantov"]
    bare = replace(found, laws=())
    assert set(room._FITTED) <= set(room.left_out(case_of(), bare))
    assert "constant" not in room.left_out(case_of(), law())


def test_a_law_of_elastic_bodies_and_its_unresolved_points_are_told(law):
    coarse = tuple(replace(point, resolved=k > 1) for k, point in enumerate(law().points))
    said = by_name(case_of(), V, law(points=coarse, yield_pressure=None))["computed"].holds
    assert said.startswith("at its 13 velocities, 2 of them not resolved by the grid; computed for")
    assert said.endswith("differs from the case: elastic")
