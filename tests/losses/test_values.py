"""Plates, half-spaces and viscosity: their coefficients against closed forms."""

import math

import pytest

from restitution.losses.half_space import HalfSpace
from restitution.losses.losses import Damping, Losses
from restitution.losses.plate import Plate
from restitution.losses.viscosity import Friction, Viscosity
from tolerance import approx

STEEL = 206e9, 0.29, 7830.0


def test_the_mobility_of_a_plate():
    """1/(8√(Dρh)) of 3 mm of steel, D = 506.1 N m."""
    plate = Plate(3e-3, *STEEL)
    stiffness = 206e9 * 27e-9 / (12 * (1 - 0.29**2))
    assert plate.mobility == approx(0.125 / math.sqrt(stiffness * 7830 * 3e-3))
    assert Plate(6e-3, *STEEL).mobility == approx(plate.mobility / 4)


def test_a_compression_wave_crosses_a_plate_and_returns():
    speed = math.sqrt(206e9 * 0.71 / (1.29 * 0.42) / 7830)
    assert Plate(3e-3, *STEEL).round_trip == approx(6e-3 / speed)
    assert Plate(3e-3, 1e6, 0.5, 1000.0).round_trip == 0.0


def test_bending_waves_come_from_as_far_as_they_run_there_and_back():
    plate, duration = Plate(3e-3, *STEEL), 20e-6
    stiffness = 206e9 * 27e-9 / (12 * (1 - 0.29**2))
    wavelength = 2 * math.pi * (stiffness / (7830 * 3e-3)) ** 0.25 / math.sqrt(math.pi / duration)
    # The group velocity is twice the phase velocity, a wavelength in two durations.
    assert 2 * plate.reach(duration) == approx(2 * wavelength / (2 * duration) * duration)


def test_two_thirds_of_the_radiated_energy_are_in_rayleigh_waves():
    """Miller and Pursey (1955): 67.4 % for ν = 0.25."""
    assert HalfSpace(1e9, 0.25, 1000.0).bulk_share == approx(0.326, abs=1e-3)


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.25, 0.33, 0.5])
def test_the_radiation_grows_with_the_compliance(nu):
    """γ ∝ 1/(ρ c³)."""
    soft, stiff = HalfSpace(1e9, nu, 1000.0), HalfSpace(4e9, nu, 1000.0)
    assert soft.radiation == approx(8 * stiff.radiation)
    assert 0 < soft.bulk_share < 1


def test_friction_counts_by_the_share_of_the_compliance():
    viscosity = Viscosity(((Friction(2e-6, 0.0), 0.25), (Friction(0.0, 0.1), 0.75)))
    losses = Losses(viscosity=viscosity)
    assert losses.damping(1e-3) == Damping(time=approx(0.25 * 2e-6 + 0.2535 * 0.75 * 0.1 * 1e-3))
    assert losses.present == ("viscosity",)
    assert losses.only("plate") == Losses()
    assert Losses().damping(1.0) == Damping()
