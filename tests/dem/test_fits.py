"""Fits of force laws: points that a force law has made give its parameters back."""

from dataclasses import replace

import numpy as np
import pytest

from restitution.dem import fits
from restitution.dem.fits import NAMES, fitted_laws, too_few_points
from restitution.laws.particle import Particle
from restitution.theory import EEPA, JKR, MDR, Luding, ThorntonNing, WaltonBraun
from tolerance import approx

V = np.geomspace(0.02, 4, 12)
WALL = Particle(name="wall", radius=None, youngs_modulus=70e9, poissons_ratio=0.25, density=None)
SMALL = Particle(
    name="small", radius=2e-4, youngs_modulus=70e9, poissons_ratio=0.25, density=2500.0
)


@pytest.fixture
def made(law):
    """A law of two glass spheres with these COR and largest forces (N) at V."""

    def make(e, force, *, resolved=None, **values):
        some = law(**values)
        seen = np.ones(V.size, dtype=bool) if resolved is None else resolved
        numbers = zip(V, np.broadcast_to(e, V.shape), force, seen, strict=True)
        points = tuple(
            replace(
                some.points[0],
                velocity=float(v),
                restitution=float(c),
                ratio=float(c) ** 2,
                loading_work=0.5 * some.mass * float(v) ** 2,
                force=float(F),
                resolved=bool(known),
            )
            for v, c, F, known in numbers
        )
        return replace(some, points=points)

    return make


@pytest.fixture
def mass(law):
    return law().mass


def fit_of(law, name):
    """One fit of `fitted_laws`, without the others."""
    found = getattr(fits, f"_{name.removeprefix('lammps-').replace('-', '_')}")(law)
    assert found.name == name
    return found


def spring_force(stiffness, mass, exponent=1.0):
    """The largest force (N) of F = kδⁿ in the impacts at V: F δ/(n + 1) = ½ m V²."""
    depth = ((exponent + 1) * 0.5 * mass * V**2 / stiffness) ** (1 / (exponent + 1))
    return stiffness * depth**exponent


def test_walton_and_braun(made, mass):
    springs = 2e6, 2.6e6, 3e5
    law = made(WaltonBraun(*springs).restitution(V, mass), spring_force(springs[0], mass))
    found = fit_of(law, "walton-braun")
    assert list(found.parameters.values()) == approx(springs, rel=1e-4)
    assert found.worst < 1e-6


@pytest.mark.parametrize("adhesive", [0.0, 2e5])
def test_luding(made, law, mass, adhesive):
    springs = 1e6, 4e6, adhesive, 0.004
    e = Luding(law().radius, *springs).restitution(V, mass)
    assert np.ptp(e) > 0.05
    w = 0.1 if adhesive else 0.0
    found = fit_of(made(e, spring_force(1e6, mass), work_of_adhesion=w), "luding")
    assert found.worst < 2e-3
    assert found.parameters["loading_stiffness_N_per_m"] == approx(1e6)
    assert found.parameters["limit_stiffness_N_per_m"] == approx(4e6, rel=0.01)
    assert found.parameters["adhesive_stiffness_N_per_m"] == approx(adhesive, rel=0.02)
    assert found.parameters["plasticity_depth"] == approx(0.004, rel=0.01)
    ends = "indentation zero" if adhesive else "separation, where the force is back to zero"
    assert found.ends == ends


def test_eepa_without_adhesion(made, mass):
    springs = 3e9, 8e9, 0.0, 0.0, 1.5
    e = EEPA(*springs).restitution(V, mass)
    found = fit_of(made(e, spring_force(3e9, mass, 1.5)), "eepa")
    assert list(found.parameters.values()) == approx(springs, rel=1e-4)
    assert "the same at every velocity" in found.note
    assert found.ends == "separation, where the force is back to zero"


def test_eepa_with_adhesion(made, mass):
    """COR alone hardly tells its three parameters apart; those found give COR back."""
    force = spring_force(3e9, mass, 1.5)
    e = EEPA(3e9, 8e9, 2e9, -0.2 * float(force.min()), 1.5).restitution(V, mass)
    assert np.ptp(e) > 0.05
    found = fit_of(made(e, force, work_of_adhesion=0.1), "eepa")
    k1, _, adhesive, constant, n = found.parameters.values()
    assert (k1, n) == (approx(3e9), 1.5)
    assert adhesive > 0 > constant > -float(force.min())
    again = EEPA(*found.parameters.values()).restitution(V, mass)
    assert list(found.restitution) == approx(again, rel=1e-12)
    assert np.abs(again - e).max() < 2e-3
    assert (found.note, found.ends) == ("", "indentation zero")


def test_mdr_on_a_wall(made, law):
    mass = law(second=WALL).mass
    E = law(second=WALL).contact_modulus * (1 - 0.25**2)
    e = MDR(1e-3, E, 0.25, 3e8).restitution(V, mass)
    found = fit_of(made(e, spring_force(1e6, mass), second=WALL), "lammps-mdr")
    assert list(found.parameters.values()) == approx([3e8, E, 0.25], rel=1e-4)
    swapped = law(first=WALL, second=law().first, points=law().points)
    assert fit_of(swapped, "lammps-mdr").parameters["youngs_modulus_Pa"] == approx(E)


def test_mdr_of_two_equal_spheres_is_two_contacts_at_half_the_velocity(made, mass):
    e = MDR(1e-3, 70e9, 0.25, 3e8).restitution(V / 2, 2 * mass)
    found = fit_of(made(e, spring_force(1e6, mass)), "lammps-mdr")
    assert list(found.parameters.values()) == approx([3e8, 70e9, 0.25], rel=1e-4)


def test_mdr_knows_no_unlike_spheres(made, law):
    unlike = made(0.5, spring_force(1e6, 1e-6), second=SMALL)
    assert [each.name for each in fitted_laws(unlike)] == list(NAMES[:-1])


@pytest.mark.parametrize("V_s", [None, 0.01])
def test_thornton_and_ning(made, law, mass, V_s):
    """From the forces and from COR; a sticking velocity is known beforehand or found."""
    smooth = ThorntonNing(law().radius, law().contact_modulus, 4e8)
    force = smooth.loading_force(smooth.indentation_from_velocity(V, mass))
    e = np.sqrt(smooth.restitution(V, mass) ** 2 - ((V_s or 0.0) / V) ** 2)
    w = 0.0 if V_s is None else 0.2
    found = made(e, force, yield_pressure=1e9, work_of_adhesion=w, sticks_below=V_s)
    for each in fits._thornton_ning(found):
        assert each.worst < 1e-6
        assert each.parameters["yield_pressure_Pa"] == approx(4e8, rel=1e-4)
        if V_s is None:
            assert list(each.parameters) == ["yield_pressure_Pa"]
            continue
        assert each.parameters["sticking_velocity_m_per_s"] == approx(V_s, rel=1e-3)
        work = each.parameters["work_of_adhesion_J_per_m2"]
        same = JKR(law().radius, law().contact_modulus, work).sticking_velocity(mass)
        assert same == approx(V_s, rel=1e-3)


def test_the_best_of_the_fits_with_a_sticking_velocity_need_not_be_the_one_known(made, law, mass):
    """The known one is of smooth bodies; COR is fitted with another."""
    smooth = ThorntonNing(law().radius, law().contact_modulus, 4e8)
    e = np.sqrt(smooth.restitution(V, mass) ** 2 - (0.012 / V) ** 2)
    force = smooth.loading_force(smooth.indentation_from_velocity(V, mass))
    found = made(e, force, work_of_adhesion=0.2, smooth_sticking_velocity=0.004)
    by_force, by_restitution = (each.parameters for each in fits._thornton_ning(found))
    assert by_force["sticking_velocity_m_per_s"] == 0.004
    assert by_restitution["sticking_velocity_m_per_s"] == approx(0.012, rel=1e-3)


@pytest.mark.parametrize("V_s", [0.0, 0.01])
@pytest.mark.parametrize("factor", [0.02, 50])
def test_thornton_and_ning_from_a_yield_pressure_that_is_far_off(made, law, mass, factor, V_s):
    """With a much larger yield pressure than that of the points, COR would not depend on it."""
    smooth = ThorntonNing(law().radius, law().contact_modulus, 4e8)
    force = smooth.loading_force(smooth.indentation_from_velocity(V, mass))
    e = np.sqrt(smooth.restitution(V, mass) ** 2 - (V_s / V) ** 2)
    adhesive = {"work_of_adhesion": 0.2, "sticks_below": V_s} if V_s else {}
    for each in fits._thornton_ning(made(e, force, yield_pressure=4e8 * factor, **adhesive)):
        assert each.parameters["yield_pressure_Pa"] == approx(4e8, rel=1e-4)


@pytest.mark.parametrize("factor", [0.02, 50])
def test_mdr_from_a_yield_pressure_that_is_far_off(made, law, factor):
    mass = law(second=WALL).mass
    E = law(second=WALL).contact_modulus * (1 - 0.25**2)
    e = MDR(1e-3, E, 0.25, 3e8).restitution(V, mass)
    found = made(e, spring_force(1e6, mass), second=WALL, yield_pressure=2.8 * 3e8 * factor)
    assert fit_of(found, "lammps-mdr").parameters["yield_strength_Pa"] == approx(3e8, rel=1e-3)


@pytest.mark.parametrize("factor", np.geomspace(0.92, 0.8, 6))
def test_no_point_lies_at_the_jump_of_mdr(made, law, factor):
    """A rough contact loses energy at the lowest velocity, too, but less than mdr can lose."""
    mass = law(second=WALL).mass
    E = law(second=WALL).contact_modulus * (1 - 0.25**2)
    found = made(factor * (V / V[0]) ** -0.02, spring_force(1e6, mass), second=WALL)
    fit = fit_of(found, "lammps-mdr")
    sphere = MDR(1e-3, E, 0.25, fit.parameters["yield_strength_Pa"])
    first_yield = np.sqrt(2 * sphere.loading_work(sphere.yield_indentation) / mass)
    assert np.abs(V / first_yield - 1).min() > 0.019
    near = sphere.restitution(np.array([[0.985], [1.015]]) * V, mass)
    np.testing.assert_allclose(near[0], near[1], atol=0.02)


def test_a_constant_is_the_mean(made):
    e = np.linspace(0.9, 0.3, V.size)
    found = fit_of(made(e, spring_force(1e6, 1e-6)), "constant")
    assert found.parameters == {"restitution": approx(e.mean())}
    assert found.rms == approx(e.std())
    assert found.worst == approx(0.3)


def test_only_resolved_points_are_fitted(made, mass):
    springs = 2e6, 2.6e6, 3e5
    e, force = WaltonBraun(*springs).restitution(V, mass), spring_force(springs[0], mass)
    resolved = np.ones(V.size, dtype=bool)
    resolved[[0, 5, -1]] = False
    e[~resolved], force[~resolved] = 0.05, 1e3
    found = fit_of(made(e, force, resolved=resolved), "walton-braun")
    assert list(found.parameters.values()) == approx(springs, rel=1e-4)
    assert found.worst < 1e-6
    empty = [value is None for value in found.restitution]
    assert empty == [k in (0, V.size - 1) for k in range(V.size)]


def test_what_sticks_or_only_pulls_has_a_constant_alone(made):
    stuck = made(0.0, spring_force(1e6, 1e-6), work_of_adhesion=0.1)
    assert [each.name for each in fitted_laws(stuck)] == ["constant"]
    pulled = made(0.5, -spring_force(1e6, 1e-6), work_of_adhesion=0.1)
    assert [each.name for each in fitted_laws(pulled)] == ["constant"]


def test_what_loses_nothing_has_no_fit(made):
    assert fitted_laws(made(0.9995, spring_force(1e6, 1e-6))) == ()
    assert fitted_laws(made(0.9985, spring_force(1e6, 1e-6)))
    nothing = np.zeros(V.size, dtype=bool)
    assert fitted_laws(made(0.5, spring_force(1e6, 1e-6), resolved=nothing)) == ()


def test_each_fit_is_announced_before_it_begins(made):
    said = []
    fitted_laws(made(0.5, spring_force(1e6, 1e-6)), lambda *begun: said.append(begun))
    assert said == [(name, k + 1, len(NAMES)) for k, name in enumerate(NAMES)]


@pytest.fixture
def pulled_off(made, mass):
    """A law with the COR and the pull-off forces of an adhesive model at V."""

    def make(model, stiffness, exponent, *, misfit=1.0):
        forces = misfit * model.pull_off_force(model.indentation_from_velocity(V, mass))
        found = made(
            model.restitution(V, mass),
            spring_force(stiffness, mass, exponent),
            work_of_adhesion=0.1,
        )
        points = zip(found.points, forces.tolist(), strict=True)
        points = tuple(replace(point, pull_off_force=force) for point, force in points)
        return replace(found, points=points)

    return make


@pytest.mark.parametrize("name", ["luding", "eepa"])
def test_adhesive_models_have_the_pull_off_force(pulled_off, mass, name):
    if name == "luding":
        k, model = 2e6, Luding(0.5e-3, 2e6, 8e6, 4e5, 0.02)
    else:
        k, model = 5e9, EEPA(5e9, 9e9, 2e9, -2e-4, 1.5)
    found = fit_of(pulled_off(model, k, 1.5 if name == "eepa" else 1.0), name)
    assert found.pull_off_misfit < 0.03
    assert found.worst < 0.01
    assert f"within {100 * found.pull_off_misfit:.2g} % of the computed one" in found.note
    assert "pull-off" in found.fitted_to
    half = fit_of(pulled_off(model, k, 1.5 if name == "eepa" else 1.0, misfit=30.0), name)
    assert half.pull_off_misfit > found.pull_off_misfit


def test_a_model_without_adhesion_is_fitted_to_adhesive_pairs(pulled_off):
    law = pulled_off(Luding(0.5e-3, 2e6, 8e6, 4e5, 0.02), 2e6, 1.0)
    fit = fit_of(law, "walton-braun")
    assert fit.pull_off_misfit is None
    assert fit.fitted_to == "the coefficient of restitution"
    assert 0 < fit.worst < 0.2


def test_adhesive_parameters_without_effect_are_zero(made, mass):
    """Without pull-off forces a law that loses energy by yielding needs no adhesion."""
    e = WaltonBraun(2e6, 4e6, 0.0).restitution(V, mass)
    found = made(e, spring_force(2e6, mass), work_of_adhesion=1e-9)
    for name in ("luding", "eepa"):
        fit = fit_of(found, name)
        adhesive = [v for key, v in fit.parameters.items() if "adhesive" in key or "const" in key]
        assert all(value == 0 or abs(value) > 1e-9 for value in adhesive)
        assert fit.pull_off_misfit is None


def test_a_fit_from_few_points_is_warned_of(made):
    few = np.arange(V.size) < 3
    for resolved, warned in ((few, True), (np.arange(V.size) < 4, False)):
        found = made(np.linspace(0.9, 0.5, V.size), spring_force(1e6, 1e-6), resolved=resolved)
        found = replace(found, laws=fitted_laws(found))
        assert bool(too_few_points(found)) == warned
    assert "fitted to 3 resolved velocities, but a reliable fit needs 4" in too_few_points(
        replace(found, points=found.points[:3])
    )
