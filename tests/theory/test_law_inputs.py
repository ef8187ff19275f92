"""The rules of `restitution.theory` on shapes, no contact and no body, kept by the impact laws."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from restitution.errors import CaseError
from restitution.theory import (
    brilliantov,
    eepa,
    jackson_green_marghitu,
    johnson,
    luding,
    mdr,
    walton_braun,
    wu_li_thornton,
)

BODY = {
    "radius": 250e-6,
    "contact_modulus": 112e9,
    "yield_strength": 270e6,
    "poisson_ratio": 0.25,
    "youngs_modulus": 100e9,
    "poissons_ratio": 0.25,
    "mass": 2e-6,
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
STATE = {"indentation": 1e-7, "maximum_indentation": 2e-7, "velocity": 0.1}
NOT_POSITIVE = (0.0, -1.0, np.inf, np.nan)
REFUSED = dict.fromkeys(BODY, NOT_POSITIVE) | {
    "poisson_ratio": (-1.0, 0.51, np.nan),
    "poissons_ratio": (-0.1, 0.51, np.nan),
    "unloading_stiffness": (0.9e6, np.inf, np.nan),
    "limit_stiffness": (0.9e6, np.inf, np.nan),
    "adhesive_stiffness": (-1.0, np.inf, np.nan),
    "hardening": (-1.0, np.inf, np.nan),
    "constant_force": (1e-9, -np.inf, np.nan),
    "exponent": (0.9, np.inf, np.nan),
}

SHARP = ("radius", "contact_modulus", "yield_strength")
SPRINGS = ("loading_stiffness", "unloading_stiffness")
LIMITED = ("radius", "loading_stiffness", "limit_stiffness")
POWER = (*SPRINGS, "adhesive_stiffness", "constant_force", "exponent")
SPHERE = ("radius", "youngs_modulus", "poissons_ratio", "yield_strength")
UNLOADING = ("indentation", "maximum_indentation")
FUNCTIONS = [
    (johnson.restitution, ("velocity", *SHARP, "mass"), 1),
    (jackson_green_marghitu.critical_velocity, (*SHARP, "poisson_ratio", "mass"), None),
    (jackson_green_marghitu.restitution, ("velocity", *SHARP, "poisson_ratio", "mass"), 1),
    (wu_li_thornton.restitution, ("velocity", *SHARP, "mass"), 1),
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
IDS = [f"{f.__module__.rsplit('.', 1)[1]}.{f.__name__}" for f, _, _ in FUNCTIONS]
every_function = pytest.mark.parametrize(("function", "names", "untouched"), FUNCTIONS, ids=IDS)
VALUES = BODY | STATE


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
        for value in (0.0, -1e-7):
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
            with pytest.raises(CaseError, match=rf"^{name}: "):
                function(**arguments)


def test_the_refusal_says_what_to_give():
    message = (
        "unloading_stiffness: 1 is not a finite number from 2 to inf; "
        "give unloading_stiffness in SI units, within that range"
    )
    with pytest.raises(ValueError, match=f"^{message}$"):
        walton_braun.restitution(1.0, np.array([1.0, 2.0]), 1.0, 0.0, 1.0)
