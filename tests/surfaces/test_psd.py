import math

import numpy as np
import pytest

from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, generate_surface
from restitution.surfaces.psd import power_spectral_density, radial_spectrum, wave_numbers
from tolerance import approx


@pytest.mark.parametrize("nodes", [(64, 64), (75, 48)])
def test_the_mean_square_is_the_integral(nodes):
    grid = Grid(nodes, (0.2e-6, 0.3e-6))
    surface = generate_surface(grid, kind="gaussian", rms=1e-7, correlation_length=2e-6, seed=1)
    cell = (2 * math.pi) ** 2 / math.prod(grid.size)
    exact = power_spectral_density(surface).sum() * cell / (2 * math.pi) ** 2
    assert exact == approx((1e-7) ** 2, rel=1e-12)


def test_a_wave_has_its_power_at_its_wave_vector():
    grid = Grid((128, 96), (0.1e-6, 0.1e-6))
    q = 2 * math.pi * 12 / grid.size[0]
    height = 3e-9 * np.cos(q * grid.x)[:, None] + np.zeros((1, 96))
    C = power_spectral_density(Surface(height, grid, {"periodicity": "periodic"}))
    assert np.argwhere(1e-6 * C.max() < C).tolist() == [[12, 0], [116, 0]]
    assert C[12, 0] == approx((3e-9) ** 2 / 4 * math.prod(grid.size))
    tapered = power_spectral_density(Surface(height, grid))
    near = np.abs(np.fft.fftfreq(128) * 128) < 16
    assert tapered[near].sum() == approx(C.sum(), rel=0.02)


def test_an_estimate_from_a_part_agrees_with_the_whole():
    # Average over seeds, because with nine tapers each mode scatters by a third.
    grid, part = Grid((512, 512), (0.1e-6, 0.1e-6)), Grid((256, 256), (0.1e-6, 0.1e-6))
    ratios = []
    for seed in range(4):
        whole = generate_surface(
            grid, kind="self-affine", rms=1e-7, hurst=0.8, rolloff=6e-6, shortest=0.8e-6, seed=seed
        )
        exact = radial_spectrum(whole)
        found = radial_spectrum(Surface(whole.height[:256, :256], part))
        between = np.exp(
            np.interp(np.log(found.wave_number), np.log(exact.wave_number), np.log(exact.density))
        )
        inside = (found.wave_number > 2 * math.pi / 2e-6) & (
            found.wave_number < 2 * math.pi / 0.9e-6
        )
        ratios.append((found.density / between)[inside])
    # At longer waves (four per part), near the roll-off, the resolution smears the spectrum.
    assert len(ratios[0]) >= 4
    assert np.mean(ratios, axis=0) == approx(1, abs=0.12)


def test_a_slope_does_not_leak_into_short_waves():
    # Not periodic: the jump at the edges would make a plain periodogram decrease as q^-2.
    grid = Grid((256, 256), (0.1e-6, 0.1e-6))
    x, y = grid.x[:, None], grid.y[None, :]
    height = 1e-7 * np.sin(2 * math.pi * x / 40e-6 + 1) * np.cos(2 * math.pi * y / 33e-6)
    spectrum = radial_spectrum(Surface(height, grid))
    steepness = np.diff(np.log(spectrum.density)) / np.diff(np.log(spectrum.wave_number))
    assert np.median(steepness[6:]) < -3.5


def test_bands_hold_every_mode_once():
    grid = Grid((60, 45), (0.1e-6, 0.2e-6))
    q = wave_numbers(grid.nodes, grid.spacing)
    spectrum = radial_spectrum(Surface(np.zeros(grid.nodes), grid), np.ones(grid.nodes))
    assert spectrum.density == approx(1)
    assert np.all(np.diff(spectrum.wave_number) > 0)
    assert spectrum.wave_number[-1] <= math.pi / 0.2e-6 * 1.001 < q.max()
