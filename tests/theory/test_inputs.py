"""The conventions that all laws share: shapes, separated spheres, invalid parameters."""

from dataclasses import FrozenInstanceError, fields, replace
from operator import attrgetter

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from restitution.errors import CaseError
from restitution.theory import (
    EEPA,
    JKR,
    MDR,
    AdhesiveThorntonNing,
    Brilliantov,
    FirstYield,
    Hertz,
    ImpactLaw,
    JacksonGreen,
    Johnson,
    Kendall,
    Luding,
    ThorntonNing,
    WaltonBraun,
    yield_coefficient,
)

MATERIAL = {
    "radius": 250e-6,
    "contact_modulus": 112e9,
    "yield_pressure": 750e6,
    "yield_strength": 270e6,
    "work_of_adhesion": 0.05,
    "youngs_modulus": 100e9,
    "poissons_ratio": 0.25,
    "dissipation": 0.1,
    "loading_stiffness": 1e6,
    "unloading_stiffness": 3e6,
    "limit_stiffness": 3e6,
    "adhesive_stiffness": 1e5,
    "plasticity_depth": 0.05,
    "hardening": 1e3,
    "constant_force": -1e-9,
    "exponent": 1.5,
}
# state of an impact; zero or negative values mean separated spheres
STATE = {
    "indentation": 1e-7,
    "maximum_indentation": 2e-7,
    "contact_radius": 1e-6,
    "force": 1e-2,
    "energy": 1e-6,
    "velocity": 0.1,
}

# arguments of a quantity that must be positive, like material parameters
GIVEN = {"mass": 2e-6, "equilibrium_separation": 3e-10, "restitution": 0.3}
VALUES = MATERIAL | STATE | GIVEN

NOT_POSITIVE = (0.0, -1.0, np.inf, np.nan)
REFUSED = dict.fromkeys(MATERIAL | GIVEN, NOT_POSITIVE) | {
    "poissons_ratio": (-1.0, 0.51, np.nan),
    "unloading_stiffness": (0.9e6, np.inf, np.nan),
    "limit_stiffness": (0.9e6, np.inf, np.nan),
    "adhesive_stiffness": (-1.0, np.inf, np.nan),
    "hardening": (-1.0, np.inf, np.nan),
    "constant_force": (1e-9, -np.inf, np.nan),
    "exponent": (0.9, np.inf, np.nan),
}

UNLOADING = ("indentation", "maximum_indentation")
DEEPEST = ("maximum_indentation",)
# law, quantity, its arguments, and its value for separated spheres
QUANTITIES = [
    (Hertz, "force", ("indentation",), 0),
    (Hertz, "force_at_contact_radius", ("contact_radius",), 0),
    (Hertz, "indentation", ("force",), 0),
    (Hertz, "indentation_from_energy", ("energy",), 0),
    (Hertz, "contact_radius", ("indentation",), 0),
    (Hertz, "contact_area", ("indentation",), 0),
    (Hertz, "stored_energy", ("indentation",), 0),
    (Hertz, "impact_velocity", ("indentation", "mass"), 0),
    (Hertz, "peak_pressure", ("indentation",), 0),
    (FirstYield, "indentation", None, None),
    (FirstYield, "force", None, None),
    (FirstYield, "velocity", ("mass",), None),
    (ThorntonNing, "loading_force", ("indentation",), 0),
    (ThorntonNing, "indentation", ("force",), 0),
    (ThorntonNing, "loading_work", ("indentation",), 0),
    (ThorntonNing, "unloading_force", UNLOADING, 0),
    (ThorntonNing, "unloading_work", DEEPEST, 0),
    (ThorntonNing, "unloading_radius", DEEPEST, MATERIAL["radius"]),
    (ThorntonNing, "residual_indentation", DEEPEST, 0),
    (ThorntonNing, "impact_velocity", (*DEEPEST, "mass"), 0),
    (ThorntonNing, "indentation_from_velocity", ("velocity", "mass"), 0),
    (ThorntonNing, "restitution", ("velocity", "mass"), 1),
    (ThorntonNing, "restitution_at_indentation", DEEPEST, 1),
    (JacksonGreen, "first_yield.indentation", None, None),
    (JacksonGreen, "first_yield.force", None, None),
    (JacksonGreen, "contact_area", ("indentation",), 0),
    (JacksonGreen, "contact_radius", ("indentation",), 0),
    (JacksonGreen, "hardness", ("contact_radius",), 2.84 * 270e6),
    (JacksonGreen, "loading_force", ("indentation",), 0),
    (JKR, "force", ("indentation",), 0),
    (JKR, "contact_radius", ("indentation",), 0),
    (JKR, "force_at_contact_radius", ("contact_radius",), 0),
    (JKR, "indentation_at_contact_radius", ("contact_radius",), 0),
    (JKR, "stored_energy_at_contact_radius", ("contact_radius",), 0),
    (JKR, "total_energy_at_contact_radius", ("contact_radius",), 0),
    (JKR, "pull_off_force", None, None),
    (JKR, "pull_off_radius", None, None),
    (JKR, "pull_off_indentation", None, None),
    (JKR, "break_force", None, None),
    (JKR, "break_radius", None, None),
    (JKR, "break_indentation", None, None),
    (JKR, "jump_in_force", None, None),
    (JKR, "zero_load_radius", None, None),
    (JKR, "adhesive_length", None, None),
    (JKR, "loading_work", ("indentation",), 0),
    (JKR, "unloading_work", ("indentation",), 0),
    (JKR, "hysteresis_loss", None, None),
    (JKR, "impact_velocity", (*DEEPEST, "mass"), 0),
    (JKR, "sticking_velocity", ("mass",), None),
    (JKR, "restitution", ("velocity", "mass"), 1),
    (JKR, "restitution_at_indentation", DEEPEST, 1),
    (JKR, "tabor_parameter", ("equilibrium_separation",), None),
    (Kendall, "pull_off_force", ("contact_radius",), 0),
    (Kendall, "pull_off_displacement", ("contact_radius",), 0),
    (AdhesiveThorntonNing, "restitution", ("velocity", "mass"), 1),
    (Johnson, "restitution", ("velocity", "mass"), 1),
    (Johnson, "velocity_at_restitution", ("restitution", "mass"), None),
    (Johnson, "velocity_at_full_radius", ("mass",), None),
    (WaltonBraun, "loading_force", ("indentation",), 0),
    (WaltonBraun, "unloading_force", UNLOADING, 0),
    (WaltonBraun, "residual_indentation", DEEPEST, 0),
    (WaltonBraun, "restitution", ("velocity", "mass"), 1),
    (Luding, "limit_indentation", None, None),
    (Luding, "loading_force", ("indentation",), 0),
    (Luding, "unloading_force", UNLOADING, 0),
    (Luding, "residual_indentation", DEEPEST, 0),
    (Luding, "pull_off_force", DEEPEST, 0),
    (Luding, "loading_work", ("indentation",), 0),
    (Luding, "unloading_work", DEEPEST, 0),
    (Luding, "indentation_from_velocity", ("velocity", "mass"), 0),
    (Luding, "restitution", ("velocity", "mass"), 1),
    (EEPA, "loading_force", ("indentation",), 0),
    (EEPA, "unloading_force", UNLOADING, 0),
    (EEPA, "residual_indentation", DEEPEST, 0),
    (EEPA, "pull_off_force", DEEPEST, 0),
    (EEPA, "loading_work", ("indentation",), 0),
    (EEPA, "unloading_work", DEEPEST, 0),
    (EEPA, "indentation_from_velocity", ("velocity", "mass"), 0),
    (EEPA, "restitution", ("velocity", "mass"), 1),
    (Brilliantov, "restitution", ("velocity",), 1),
    (MDR, "yield_pressure", ("indentation",), 2.75 * 270e6),
    (MDR, "yield_indentation", None, None),
    (MDR, "loading_force", ("indentation",), 0),
    (MDR, "loading_work", ("indentation",), 0),
    (MDR, "unloading_force", UNLOADING, 0),
    (MDR, "residual_indentation", DEEPEST, 0),
    (MDR, "unloading_work", DEEPEST, 0),
    (MDR, "indentation_from_velocity", ("velocity", "mass"), 0),
    (MDR, "restitution", ("velocity", "mass"), 1),
]
LAWS = list(dict.fromkeys(law for law, *_ in QUANTITIES))
IMPACT_LAWS: list[type[ImpactLaw]] = [
    law
    for law, name, names, _ in QUANTITIES
    if name == "restitution" and names == ("velocity", "mass")
]
HELD_AT_ZERO = (JKR, "force"), (JKR, "contact_radius"), (JKR, "unloading_work")  # adhesive
# parameters of the law without effect on a quantity
LEFT_OUT = {
    (Hertz, "contact_radius"): ("contact_modulus",),
    (Hertz, "contact_area"): ("contact_modulus",),
    (JacksonGreen, "hardness"): ("contact_modulus", "poissons_ratio"),
    (JKR, "pull_off_force"): ("contact_modulus",),
    (JKR, "break_force"): ("contact_modulus",),
    (JKR, "jump_in_force"): ("contact_modulus",),
    (WaltonBraun, "loading_force"): ("unloading_stiffness", "hardening"),
    (MDR, "yield_pressure"): ("youngs_modulus", "poissons_ratio"),
    (Luding, "limit_indentation"): ("adhesive_stiffness",),
    (Luding, "loading_force"): ("adhesive_stiffness",),
    (Luding, "residual_indentation"): ("adhesive_stiffness",),
    (Luding, "loading_work"): ("adhesive_stiffness",),
    (Luding, "indentation_from_velocity"): ("adhesive_stiffness",),
    (EEPA, "loading_force"): ("unloading_stiffness", "adhesive_stiffness"),
    (EEPA, "residual_indentation"): ("adhesive_stiffness", "constant_force"),
    (EEPA, "loading_work"): ("unloading_stiffness", "adhesive_stiffness"),
    (EEPA, "indentation_from_velocity"): ("unloading_stiffness", "adhesive_stiffness"),
    (Johnson, "velocity_at_full_radius"): ("contact_modulus",),
}
every_law = pytest.mark.parametrize("law", LAWS, ids=lambda law: law.__name__)
every_quantity = pytest.mark.parametrize(
    ("law", "quantity", "names", "untouched"),
    QUANTITIES,
    ids=[f"{law.__name__}.{quantity}" for law, quantity, *_ in QUANTITIES],
)


def parameters(law):
    return [field.name for field in fields(law)]


def made(law, **other):
    """Law of the default material with the parameters `other` instead of its own."""
    return law(**{name: other.get(name, MATERIAL[name]) for name in parameters(law)})


def found(law, quantity, names, values=VALUES):
    """Value of a quantity of a law at the arguments `values`."""
    value = attrgetter(quantity)(made(law, **values))
    return value if names is None else value(**{name: values[name] for name in names})


@every_quantity
def test_numbers_give_a_number_and_arrays_broadcast(law, quantity, names, untouched):
    number = found(law, quantity, names)
    assert isinstance(number, float)
    left_out = LEFT_OUT.get((law, quantity), ())
    varied = [name for name in (*parameters(law), *(names or ())) if name not in left_out]
    values = dict(VALUES)
    for axis, name in enumerate(varied):
        shape = [1] * len(varied)
        shape[axis] = 2
        values[name] = np.full(shape, values[name])
    result = found(law, quantity, names, values)
    assert result.shape == (2,) * len(varied)
    assert_array_equal(result, number)


@every_quantity
def test_no_contact_is_an_answer(law, quantity, names, untouched):
    states = [name for name in names or () if name in STATE]
    for state in states:
        for value in (-1e-7,) if (law, quantity) in HELD_AT_ZERO else (0.0, -1e-7):
            values = VALUES | {state: value}
            if state == "maximum_indentation":  # the indentation must not exceed it
                values |= dict.fromkeys(states, value)
            assert found(law, quantity, names, values) == untouched
        assert np.isnan(found(law, quantity, names, VALUES | {state: np.nan}))


@every_quantity
def test_an_argument_that_cannot_be_is_refused_by_name(law, quantity, names, untouched):
    for name in names or ():
        for value in REFUSED.get(name, ()):
            with pytest.raises(CaseError, match=f"^{name}: "):
                found(law, quantity, names, VALUES | {name: np.array([VALUES[name], value])})


@every_law
def test_a_body_that_cannot_be_is_refused_by_name(law):
    for name in parameters(law):
        for value in REFUSED[name]:
            with pytest.raises(CaseError, match=f"^{name}: "):
                made(law, **{name: np.array([MATERIAL[name], value])})


def test_mdr_takes_no_negative_poissons_ratio():
    with pytest.raises(CaseError, match=r"^poissons_ratio: -0\.1 is not a finite number from 0 to"):
        made(MDR, poissons_ratio=-0.1)


@every_law
def test_a_law_is_frozen(law):
    for name in parameters(law):
        values = np.full(2, MATERIAL[name])
        several = made(law, **{name: values})
        with pytest.raises(FrozenInstanceError):
            setattr(several, name, 1.0)
        with pytest.raises(ValueError, match="read-only"):
            getattr(several, name)[0] = 1.0
        values[0] = np.nan  # the law copied its fields
        assert np.isfinite(getattr(several, name)).all()
    law = made(law)
    assert law == law
    assert law != replace(law)
    assert len({law, replace(law)}) == 2


@pytest.mark.parametrize("law", IMPACT_LAWS, ids=lambda law: law.__name__)
def test_every_law_of_an_impact_answers_with_a_part_of_the_velocity(law):
    impact: ImpactLaw = made(law)
    e = impact.restitution(np.geomspace(1e-6, 10, 50), 2e-6)
    assert np.all((e >= 0) & (e <= 1))


def test_the_dissipation_of_a_material_broadcasts_and_refuses_by_name():
    material = {"radius": 250e-6, "contact_modulus": 112e9, "dissipative_time": 1e-6, "mass": 2e-6}
    number = Brilliantov.from_material(**material).dissipation
    for name in material:
        several = Brilliantov.from_material(**material | {name: np.full(2, material[name])})
        assert_array_equal(several.dissipation, np.full(2, number))
        for value in NOT_POSITIVE:
            with pytest.raises(CaseError, match=f"^{name}: "):
                Brilliantov.from_material(**material | {name: value})


def test_the_yield_coefficient_broadcasts_and_refuses_by_name():
    number = yield_coefficient(0.25)
    assert isinstance(number, float)
    assert_array_equal(yield_coefficient(np.full((2, 1), 0.25)), np.full((2, 1), number))
    for value in (-1.0, 0.51, np.nan):
        with pytest.raises(CaseError, match=r"^poissons_ratio: "):
            yield_coefficient(np.array([0.25, value]))


def test_the_refusal_is_a_value_error_that_says_what_to_give():
    with pytest.raises(ValueError, match="radius: -1 is not a positive finite number; give radius"):
        Hertz(-1.0, 1e9)


def test_the_refusal_names_the_range():
    message = (
        "unloading_stiffness: 1 is not a finite number from 2 to inf; "
        "give unloading_stiffness in SI units, within that range"
    )
    with pytest.raises(ValueError, match=f"^{message}$"):
        WaltonBraun(np.array([1.0, 2.0]), 1.0, 0.0)
