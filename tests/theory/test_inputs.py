"""The rules every closed form shares: shapes, no contact, no body."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from restitution.errors import CaseError
from restitution.theory import (
    adhesive_thornton_ning,
    brilliantov,
    eepa,
    hertz,
    jackson_green,
    jkr,
    johnson,
    kendall,
    luding,
    mdr,
    sticking,
    thornton_ning,
    walton_braun,
    yielding,
)

MATERIAL = {
    "radius": 250e-6,
    "contact_modulus": 112e9,
    "yield_pressure": 750e6,
    "yield_strength": 270e6,
    "poisson_ratio": 0.25,
    "mass": 2e-6,
    "work_of_adhesion": 0.05,
    "equilibrium_separation": 3e-10,
    "sticking_velocity": 1e-3,
    "youngs_modulus": 100e9,
    "poissons_ratio": 0.25,
    "dissipation": 0.1,
    "dissipative_time": 1e-6,
    "loading_stiffness": 1e6,
    "unloading_stiffness": 3e6,
    "limit_stiffness": 3e6,
    "adhesive_stiffness": 1e5,
    "plasticity_depth": 0.05,
    "hardening": 1e3,
    "constant_force": -1e-9,
    "exponent": 1.5,
}
# what changes during an impact: zero or less means that nothing touches
STATE = {
    "indentation": 1e-7,
    "maximum_indentation": 2e-7,
    "contact_radius": 1e-6,
    "force": 1e-2,
    "velocity": 0.1,
}

NOT_POSITIVE = (0.0, -1.0, np.inf, np.nan)
REFUSED = dict.fromkeys(MATERIAL, NOT_POSITIVE) | {
    "poisson_ratio": (-1.0, 0.51, np.nan),
    "poissons_ratio": (-0.1, 0.51, np.nan),
    "unloading_stiffness": (0.9e6, np.inf, np.nan),
    "limit_stiffness": (0.9e6, np.inf, np.nan),
    "adhesive_stiffness": (-1.0, np.inf, np.nan),
    "hardening": (-1.0, np.inf, np.nan),
    "constant_force": (1e-9, -np.inf, np.nan),
    "exponent": (0.9, np.inf, np.nan),
}

SHARED = ("radius", "contact_modulus")
SHARP = (*SHARED, "yield_pressure")
SOFT = (*SHARED, "yield_strength", "poisson_ratio")
STICKY = (*SHARED, "work_of_adhesion")
STRONG = (*SHARED, "yield_strength")
SPRINGS = ("loading_stiffness", "unloading_stiffness")
LIMITED = ("radius", "loading_stiffness", "limit_stiffness")
POWER = (*SPRINGS, "adhesive_stiffness", "constant_force", "exponent")
SPHERE = ("radius", "youngs_modulus", "poissons_ratio", "yield_strength")
UNLOADING = ("indentation", "maximum_indentation")
FUNCTIONS = [
    (hertz.force, ("indentation", *SHARED), 0),
    (hertz.indentation_from_force, ("force", *SHARED), 0),
    (hertz.contact_radius, ("indentation", "radius"), 0),
    (hertz.contact_area, ("indentation", "radius"), 0),
    (hertz.stored_energy, ("indentation", *SHARED), 0),
    (hertz.peak_pressure, ("indentation", *SHARED), 0),
    (yielding.yield_indentation, SHARP, None),
    (yielding.yield_force, SHARP, None),
    (yielding.yield_velocity, (*SHARP, "mass"), None),
    (thornton_ning.loading_force, ("indentation", *SHARP), 0),
    (thornton_ning.loading_work, ("indentation", *SHARP), 0),
    (thornton_ning.unloading_force, ("indentation", "maximum_indentation", *SHARP), 0),
    (thornton_ning.unloading_work, ("maximum_indentation", *SHARP), 0),
    (thornton_ning.unloading_radius, ("maximum_indentation", *SHARP), MATERIAL["radius"]),
    (thornton_ning.residual_indentation, ("maximum_indentation", *SHARP), 0),
    (thornton_ning.impact_velocity, ("maximum_indentation", *SHARP, "mass"), 0),
    (thornton_ning.indentation_from_velocity, ("velocity", *SHARP, "mass"), 0),
    (thornton_ning.restitution, ("velocity", *SHARP, "mass"), 1),
    (thornton_ning.restitution_at_indentation, ("maximum_indentation", *SHARP), 1),
    (jackson_green.yield_coefficient, ("poisson_ratio",), None),
    (jackson_green.critical_indentation, SOFT, None),
    (jackson_green.critical_force, SOFT, None),
    (jackson_green.contact_area, ("indentation", *SOFT), 0),
    (jackson_green.contact_radius, ("indentation", *SOFT), 0),
    (jackson_green.hardness, ("contact_radius", "radius", "yield_strength"), 2.84 * 270e6),
    (jackson_green.loading_force, ("indentation", *SOFT), 0),
    (jkr.force, ("indentation", *STICKY), 0),
    (jkr.contact_radius, ("indentation", *STICKY), 0),
    (jkr.force_at_contact_radius, ("contact_radius", *STICKY), 0),
    (jkr.indentation_at_contact_radius, ("contact_radius", *STICKY), 0),
    (jkr.stored_energy_at_contact_radius, ("contact_radius", *STICKY), 0),
    (jkr.total_energy_at_contact_radius, ("contact_radius", *STICKY), 0),
    (jkr.pull_off_force, ("radius", "work_of_adhesion"), None),
    (jkr.pull_off_radius, STICKY, None),
    (jkr.pull_off_indentation, STICKY, None),
    (jkr.break_force, ("radius", "work_of_adhesion"), None),
    (jkr.break_radius, STICKY, None),
    (jkr.break_indentation, STICKY, None),
    (jkr.jump_in_force, ("radius", "work_of_adhesion"), None),
    (jkr.zero_load_radius, STICKY, None),
    (jkr.loading_work, ("indentation", *STICKY), 0),
    (jkr.unloading_work, ("indentation", *STICKY), 0),
    (jkr.hysteresis_loss, STICKY, None),
    (jkr.impact_velocity, ("maximum_indentation", *STICKY, "mass"), 0),
    (jkr.restitution, ("velocity", *STICKY, "mass"), 1),
    (jkr.restitution_at_indentation, ("maximum_indentation", *STICKY), 1),
    (kendall.pull_off_force, ("contact_radius", "contact_modulus", "work_of_adhesion"), 0),
    (kendall.pull_off_displacement, ("contact_radius", "contact_modulus", "work_of_adhesion"), 0),
    (sticking.sticking_velocity, (*STICKY, "mass"), None),
    (sticking.restitution, ("velocity", "sticking_velocity"), 1),
    (sticking.tabor_parameter, (*STICKY, "equilibrium_separation"), None),
    (adhesive_thornton_ning.restitution, ("velocity", *SHARP, "work_of_adhesion", "mass"), 1),
    (johnson.restitution, ("velocity", *STRONG, "mass"), 1),
    (walton_braun.loading_force, ("indentation", "loading_stiffness"), 0),
    (walton_braun.unloading_force, (*UNLOADING, *SPRINGS, "hardening"), 0),
    (walton_braun.residual_indentation, ("maximum_indentation", *SPRINGS, "hardening"), 0),
    (walton_braun.restitution, ("velocity", *SPRINGS, "hardening", "mass"), 1),
    (luding.limit_indentation, (*LIMITED, "plasticity_depth"), None),
    (luding.loading_force, ("indentation", *LIMITED, "plasticity_depth"), 0),
    (luding.unloading_force, (*UNLOADING, *LIMITED, "adhesive_stiffness", "plasticity_depth"), 0),
    (luding.residual_indentation, ("maximum_indentation", *LIMITED, "plasticity_depth"), 0),
    (
        luding.pull_off_force,
        ("maximum_indentation", *LIMITED, "adhesive_stiffness", "plasticity_depth"),
        0,
    ),
    (luding.loading_work, ("indentation", *LIMITED, "plasticity_depth"), 0),
    (
        luding.unloading_work,
        ("maximum_indentation", *LIMITED, "adhesive_stiffness", "plasticity_depth"),
        0,
    ),
    (luding.indentation_from_velocity, ("velocity", *LIMITED, "plasticity_depth", "mass"), 0),
    (
        luding.restitution,
        ("velocity", *LIMITED, "adhesive_stiffness", "plasticity_depth", "mass"),
        1,
    ),
    (
        eepa.loading_force,
        ("indentation", "loading_stiffness", "constant_force", "exponent"),
        0,
    ),
    (eepa.unloading_force, (*UNLOADING, *POWER), 0),
    (eepa.residual_indentation, ("maximum_indentation", *SPRINGS, "exponent"), 0),
    (eepa.pull_off_force, ("maximum_indentation", *POWER), 0),
    (
        eepa.loading_work,
        ("indentation", "loading_stiffness", "constant_force", "exponent"),
        0,
    ),
    (eepa.unloading_work, ("maximum_indentation", *POWER), 0),
    (
        eepa.indentation_from_velocity,
        ("velocity", "loading_stiffness", "constant_force", "exponent", "mass"),
        0,
    ),
    (eepa.restitution, ("velocity", *POWER, "mass"), 1),
    (brilliantov.restitution, ("velocity", "dissipation"), 1),
    (
        brilliantov.dissipation_from_material,
        ("radius", "contact_modulus", "dissipative_time", "mass"),
        None,
    ),
    (mdr.yield_pressure, ("indentation", "radius", "yield_strength"), 2.75 * 270e6),
    (mdr.yield_indentation, SPHERE, None),
    (mdr.loading_force, ("indentation", *SPHERE), 0),
    (mdr.loading_work, ("indentation", *SPHERE), 0),
    (mdr.unloading_force, (*UNLOADING, *SPHERE), 0),
    (mdr.residual_indentation, ("maximum_indentation", *SPHERE), 0),
    (mdr.unloading_work, ("maximum_indentation", *SPHERE), 0),
    (mdr.indentation_from_velocity, ("velocity", *SPHERE, "mass"), 0),
    (mdr.restitution, ("velocity", *SPHERE, "mass"), 1),
]
HELD_AT_ZERO = jkr.force, jkr.contact_radius, jkr.unloading_work  # down to their break
IDS = [f"{f.__module__.rsplit('.', 1)[1]}.{f.__name__}" for f, _, _ in FUNCTIONS]
every_function = pytest.mark.parametrize(("function", "names", "untouched"), FUNCTIONS, ids=IDS)
VALUES = MATERIAL | STATE


@every_function
def test_numbers_give_a_number_and_arrays_broadcast(function, names, untouched):
    arguments = {name: VALUES[name] for name in names}
    number = function(**arguments)
    assert isinstance(number, float)
    for axis, name in enumerate(names):
        shape = [1] * len(names)
        shape[axis] = 2
        arguments[name] = np.full(shape, arguments[name])
    result = function(**arguments)
    assert result.shape == (2,) * len(names)
    assert_array_equal(result, number)


@every_function
def test_no_contact_is_an_answer(function, names, untouched):
    states = [name for name in names if name in STATE]
    for state in states:
        for value in (-1e-7,) if function in HELD_AT_ZERO else (0.0, -1e-7):
            arguments = {name: VALUES[name] for name in names} | {state: value}
            if state == "maximum_indentation":  # below it nothing has touched either
                arguments |= dict.fromkeys(states, value)
            assert function(**arguments) == untouched
        undefined = {name: VALUES[name] for name in names} | {state: np.nan}
        assert np.isnan(function(**undefined))


@every_function
def test_a_body_that_cannot_be_is_refused_by_name(function, names, untouched):
    for name in names:
        for value in REFUSED.get(name, ()):
            arguments = {n: VALUES[n] for n in names} | {name: np.array([VALUES[name], value])}
            with pytest.raises(CaseError, match=f"^{name}: "):
                function(**arguments)


def test_the_refusal_is_a_value_error_that_says_what_to_give():
    with pytest.raises(ValueError, match="radius: -1 is not a positive finite number; give radius"):
        hertz.force(1e-6, -1.0, 1e9)


def test_the_refusal_names_the_range():
    message = (
        "unloading_stiffness: 1 is not a finite number from 2 to inf; "
        "give unloading_stiffness in SI units, within that range"
    )
    with pytest.raises(ValueError, match=f"^{message}$"):
        walton_braun.restitution(1.0, np.array([1.0, 2.0]), 1.0, 0.0, 1.0)
