import shutil
import subprocess
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad

from restitution.theory import MDR, Hertz, ThorntonNing
from tolerance import approx

R, E, NU, Y = 1e-3, 70e9, 0.33, 300e6
LAW = MDR(R, E, NU, Y)
E_STAR = E / (1 - NU**2)
HERTZ = Hertz(R, E_STAR)
MASS = 4 / 3 * np.pi * R**3 * 2700
D_Y = LAW.yield_indentation
plastic_depths = st.floats(1.0, 500.0).map(lambda x: x * D_Y)

ONE_SPHERE = f"""
units si
atom_style sphere 1
atom_modify map array
newton off
boundary f f f
comm_modify vel yes
region box block -0.01 0.01 -0.01 0.01 -0.01 0.01
create_box 1 box
create_atoms 1 single 0 0 {R * (1 + 1e-9)!r}
set group all diameter {2 * R} density 2700
pair_style granular
variable law string "mdr {E} {NU} {Y} 0 0.5 0 tangential linear_history 0 0 0 damping mdr 1"
pair_coeff * * ${{law}}
region floor plane 0 0 0 0 0 1
fix motion all nve/sphere
timestep 1e-9
variable z equal z[1]
variable u equal vz[1]
variable F equal fz[1]
thermo_style custom v_z v_u v_F
thermo_modify format float %.15g
"""
WALL = """
fix wall all wall/gran/region granular ${law} region floor
velocity all set 0 0 -{V}
"""
PAIR = f"""
create_atoms 1 single 0 0 {-R * (1 + 1e-9)!r}
set group all diameter {2 * R} density 2700
velocity all set 0 0 -{{V}}
group lower id 2
velocity lower set 0 0 {{V}}
"""


def test_yield_is_where_the_mean_hertz_pressure_reaches_that_of_the_yielded_contact():
    mean = HERTZ.force(D_Y) / HERTZ.contact_area(D_Y)
    assert_allclose(LAW.yield_pressure(D_Y), mean, rtol=1e-13)
    assert 2.7 < mean / Y < 2.75
    assert LAW.yield_pressure(R) == approx(1.02 * Y, rel=0.01)


def test_first_loading_is_hertz_up_to_yield_and_continuous_there():
    d = np.array([0.1, 0.5, 1.0]) * D_Y
    assert_allclose(LAW.loading_force(d), HERTZ.force(d), rtol=1e-14)
    below, above = LAW.loading_force(np.array([1 - 1e-9, 1 + 1e-9]) * D_Y)
    assert above == approx(below, rel=1e-8)


def test_a_yielded_contact_spreads_over_the_section_of_the_sphere():
    d = 0.1 * R
    area = LAW.loading_force(d) / LAW.yield_pressure(d)
    assert_allclose(area, np.pi * (2 * R * d - d**2 - D_Y * (R - D_Y)), rtol=1e-13)


@pytest.mark.parametrize("x", [1.01, 2.0, 30.0, 500.0])
def test_the_works_are_the_integrals_of_the_forces(x):
    d = x * D_Y
    W_l = sum(
        quad(LAW.loading_force, low, high, epsabs=0, epsrel=1e-8)[0]
        for low, high in ((0, D_Y), (D_Y, d))
    )
    assert_allclose(LAW.loading_work(d), W_l, rtol=1e-7)
    low = LAW.residual_indentation(d)
    W_u, _ = quad(LAW.unloading_force, low, d, args=(d,), epsabs=0, epsrel=1e-7)
    assert_allclose(LAW.unloading_work(d), W_u, rtol=1e-6)


@settings(deadline=None, max_examples=30)
@given(plastic_depths)
def test_unloading_starts_at_the_loading_force_and_ends_at_zero(d):
    F, d_p = LAW.loading_force(d), LAW.residual_indentation(d)
    assert 0 <= d_p < d
    assert_allclose(LAW.unloading_force(d, d), F, rtol=1e-12)
    assert LAW.unloading_force(d_p * (1 - 1e-12), d) == approx(0, abs=1e-9 * F)
    further = 1.5 * d
    assert LAW.unloading_force(further, d) == LAW.loading_force(further)


def test_unloading_starts_as_a_flat_punch_stiffened_by_the_recovery():
    # dF/dδ of the ellipse at half height is 2E*a, divided by 1 + δ_R/d < 1 for the finite sphere
    d = 20 * D_Y
    h = 1e-6 * d
    slope = (LAW.loading_force(d) - LAW.unloading_force(d - h, d)) / h
    a = (LAW.loading_force(d) / (np.pi * LAW.yield_pressure(d))) ** 0.5
    depth = 2 * LAW.yield_pressure(d) * a / E_STAR
    recovered = (d - LAW.residual_indentation(d)) / depth
    assert 0.8 < recovered < 1
    assert slope == approx(2 * E_STAR * a / recovered, rel=1e-4)


def test_nothing_is_lost_below_yield():
    d = 0.7 * D_Y
    assert LAW.residual_indentation(d) == 0
    assert LAW.unloading_work(d) == LAW.loading_work(d)
    assert_allclose(LAW.unloading_force(0.3 * D_Y, d), HERTZ.force(0.3 * D_Y))
    V = (2 * LAW.loading_work(d) / MASS) ** 0.5
    assert LAW.restitution(V, MASS) == 1


def test_restitution_by_velocity_is_the_root_of_the_ratio_of_the_works():
    V = np.geomspace(0.3, 50, 20)
    d = LAW.indentation_from_velocity(V, MASS)
    W_l = LAW.loading_work(d)
    assert_allclose(W_l, 0.5 * MASS * V**2, rtol=1e-10)
    e = LAW.restitution(V, MASS)
    assert_allclose(e, (LAW.unloading_work(d) / W_l) ** 0.5, rtol=1e-9)
    assert np.all(np.diff(e[1:]) < 0)


@pytest.mark.parametrize("yield_strain", [1e-5, 1e-3, 1e-2])
def test_restitution_leaves_one_by_a_step(yield_strain):
    # at one p_Y and a: W_l = ⅖Fδ_Y with p_Y = 4E*a/3πR, and W_u = (1 + δ_R/d) 8p_Y²a³/3E*
    law = MDR(R, E, NU, yield_strain * E)
    depth = law.yield_indentation
    V_Y = (2 * law.loading_work(depth) / MASS) ** 0.5
    below, above = law.restitution(np.array([1 - 1e-6, 1 + 1e-6]) * V_Y, MASS)
    a, d = (R * depth) ** 0.5, depth * (1 + 1e-6)
    p_Y = law.yield_pressure(depth)
    recovered = (d - law.residual_indentation(d)) * E_STAR / (2 * p_Y * a)
    assert below == 1
    assert above == approx((recovered * 8 / 3 / (0.3 * np.pi**2)) ** 0.5, rel=1e-4)


def test_only_ratios_matter():
    scaled = MDR(3 * R, 2 * E, NU, 2 * Y)
    e = LAW.restitution(2.0, MASS)
    assert_allclose(scaled.restitution(2.0, 27 * 2 * MASS), e, rtol=1e-12)


def test_it_lies_near_thornton_and_ning_at_the_same_peak_pressure():
    # a mean pressure of 2.75 Y is a peak Hertz pressure of 4.1 Y (LAMMPS, V = 0.5 and 2.5 m/s)
    V = np.array([0.5, 2.5])
    other = ThorntonNing(R, E_STAR, 4.1 * Y).restitution(V, MASS)
    assert_allclose(LAW.restitution(V, MASS), other, rtol=0.15)


def test_a_sphere_driven_in_by_more_than_its_radius_has_no_answer():
    assert np.isnan(LAW.loading_force(1.01 * R))
    assert np.isnan(LAW.unloading_work(1.01 * R))
    assert np.isnan(LAW.restitution(1e5, MASS))
    assert np.isfinite(LAW.restitution(100.0, MASS))


@pytest.mark.parametrize("V", [0.25, 0.27, 1.0, 5.0])  # yield: 0.2611 m/s
def test_the_restitution_of_lammps_on_a_wall(V, lammps):
    path = lammps(ONE_SPHERE + WALL.replace("{V}", str(V)), V)
    assert path[-1, 1] / V == approx(LAW.restitution(V, MASS), abs=3e-4)


@pytest.mark.parametrize(("V", "published"), [(0.5, 0.908), (2.5, 0.613)])
def test_the_restitution_of_lammps_of_two_equal_spheres(V, published, lammps):
    path = lammps(ONE_SPHERE + PAIR.replace("{V}", str(V)), V)
    e = LAW.restitution(V, MASS)
    assert path[-1, 1] / V == approx(e, abs=3e-4)
    assert round(float(e), 3) == published


def test_the_force_of_lammps(lammps):
    path = lammps(ONE_SPHERE + WALL.replace("{V}", "5"), 5)
    d, F = (R - path[:, 0]), path[:, 2]
    turn = np.argmax(d)
    ours = np.concatenate(
        [
            LAW.loading_force(d[: turn + 1]),
            LAW.unloading_force(d[turn + 1 :], d[turn]),
        ]
    )
    assert_allclose(ours, F, rtol=0, atol=1e-3 * F.max())
    assert np.count_nonzero(F) > 50


@pytest.fixture
def lammps(lammps_environment, tmp_path):
    """Run a LAMMPS script; return rows of height, velocity and force, up to separation or later."""
    program = shutil.which("lmp", path=lammps_environment["PATH"])
    if program is None:
        pytest.skip("LAMMPS (lmp) is not installed")
    return partial(run_lammps, program, lammps_environment, tmp_path)


def run_lammps(program, environment, folder, script, V):
    steps = int(4e-5 / V**0.2 / 1e-9)
    (folder / "in.lmp").write_text(f"{script}\nthermo 50\nrun {steps}\n")
    result = subprocess.run(
        [program, "-in", "in.lmp", "-log", "none"],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    if "error while loading shared libraries" in result.stderr:
        pytest.skip(f"LAMMPS does not start: {result.stderr.strip()}")
    assert result.returncode == 0, result.stdout[-2000:]
    table = result.stdout.split("v_F", 1)[1].split("Loop time", 1)[0]
    return np.array(table.split(), dtype=float).reshape(-1, 3)
