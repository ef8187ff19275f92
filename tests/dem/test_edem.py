"""The tables for EDEM; EDEM itself is not run."""

import csv
import math
from dataclasses import replace

from contacts import sticking_law
from restitution.dem.codes.edem import write
from restitution.dem.pair_table import pair_table
from restitution.laws.law import FittedLaw
from restitution.theory import EEPA
from tolerance import approx

SPRINGS = FittedLaw(
    name="walton-braun",
    source="",
    fitted_to="",
    parameters={
        "loading_stiffness_N_per_m": 1e6,
        "unloading_stiffness_N_per_m": 1.5e6,
        "hardening_per_m": 2e5,
    },
    ends="",
    restitution=(),
    rms=0.0,
    worst=0.0,
)


def rows(text):
    lines = text.splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def test_every_pair_has_its_row(mixed):
    table = rows(write(mixed, 1.0)["restitution_edem.csv"])
    assert len(table) == 5
    for row, (_, _, law) in zip(table, mixed.pairs(), strict=True):
        assert float(row["coefficient_of_restitution"]) == approx(law.at(1.0).restitution)
        assert float(row["restitution_error"]) == approx(law.at(1.0).error, rel=0.05)
        assert row["hysteretic_K1_N_per_m"] == ""
    assert [table[1]["material_1"], table[1]["material_2"]] == ["glass_1", "steel_2"]


def test_materials_have_both_moduli(mixed):
    glass, _, plate = rows(write(mixed, 1.0)["restitution_edem_materials.csv"])
    assert float(glass["youngs_modulus_Pa"]) == 70e9
    assert float(glass["shear_modulus_Pa"]) == approx(28e9)
    assert plate["radius_m"] == plate["solids_density_kg_per_m3"] == ""


def test_springs_are_those_at_the_velocity(law):
    from restitution.theory import WaltonBraun

    found = law(laws=(SPRINGS,))
    (row,) = rows(write(pair_table([found]), 0.7)["restitution_edem.csv"])
    e = WaltonBraun(1e6, 1.5e6, 2e5).restitution(0.7, found.mass)
    assert float(row["hysteretic_restitution"]) == approx(e)
    ratio = float(row["hysteretic_K1_N_per_m"]) / float(row["hysteretic_K2_N_per_m"])
    assert ratio == approx(e**2)
    assert float(row["hysteretic_yield_strength_Pa"]) == approx(1e6 / (5 * 0.5e-3))


def test_springs_are_left_out_beyond_the_velocities_they_were_fitted_to(law):
    coarse = tuple(replace(point, resolved=point.velocity > 0.05) for point in law().points)
    table = pair_table([law(laws=(SPRINGS,), points=coarse)])
    for V, known in ((0.03, False), (0.1, True)):
        (row,) = rows(write(table, V)["restitution_edem.csv"])
        assert row["coefficient_of_restitution"]
        assert bool(row["hysteretic_K2_N_per_m"]) == known


def test_laws_with_walls_only_are_enough(on_wall):
    (row,) = rows(write(on_wall, 1.0)["restitution_edem.csv"])
    assert row["material_2"] == "plate_2"


def test_pairs_that_stick_are_named(law, constant):
    said = write(pair_table([constant(law(), 0.0)]), 1.0)["restitution_edem.csv"]
    assert "# WARNING: pair 1 1 sticks at 1" in said


def test_adhesive_pairs_have_jkr_and_eepa_with_their_misfit(law):
    sticky = sticking_law(law, replace(law().first, radius=5e-6, youngs_modulus=3e9))
    force = sticky.points[-1].pull_off_force
    plate = replace(sticky.first, name="plate", radius=None)
    row, dry = rows(
        write(pair_table([sticky, law(sticky.first, plate)]), 0.3)["restitution_edem.csv"]
    )
    gamma = float(row["jkr_v2_surface_energy_J_per_m2"])
    assert gamma == approx(force / (1.5 * math.pi * sticky.radius), rel=1e-5)
    # The law is JKR's, which is what JKR V2 has without further damping.
    assert float(row["jkr_v2_sticks_below_m_per_s"]) == approx(sticky.sticks_below, rel=0.04)
    assert float(row["jkr_v2_worst"]) < 0.03
    assert float(row["jkr_v2_restitution"]) > 0.97
    ratio, k1 = float(row["eepa_plasticity_ratio"]), 4 / 3 * sticky.contact_modulus
    k1 *= sticky.radius**0.5
    V, e = sticky.column("velocity"), sticky.column("restitution")
    off = abs(EEPA(k1, k1 / (1 - ratio), 0.0, -force, 1.5).restitution(V, sticky.mass) - e).max()
    assert float(row["eepa_worst"]) == approx(float(off), rel=1e-3)
    assert float(row["eepa_f0_N"]) == approx(-force, rel=1e-5)
    assert dry["jkr_v2_restitution"] == dry["eepa_f0_N"] == ""


def test_names_are_escaped_and_warnings_carried(hostile, law):
    files = write(pair_table([law(hostile, hostile, warnings=("coarse\n=1+1",))]), 1.0)
    for name, text in files.items():
        assert text.isascii()
        assert "WARNING: pair 1 1: coarse/n=1+1" in text
        assert name.endswith(".txt") or len(rows(text)) == 1
