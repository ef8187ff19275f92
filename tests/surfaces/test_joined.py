"""Joined spectra of several scans of one surface."""

from dataclasses import replace

import numpy as np
import pytest

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, describe, level, rms_slope
from restitution.surfaces.clean import fill_harmonically
from restitution.surfaces.joined import response
from restitution.surfaces.joined.join import join
from restitution.surfaces.joined.places import ranges, scatter_between_places, scatter_in
from restitution.surfaces.joined.scan_spectrum import ScanSpectrum
from restitution.surfaces.joined.tip import tip_cut_off
from restitution.surfaces.joined.twin import twin_of_scans
from restitution.surfaces.noise import white_noise
from restitution.surfaces.psd import power_spectral_density, wave_numbers
from restitution.surfaces.surface import is_periodic
from tolerance import approx
from virtual_instruments import KnownSurface

KNOWN = KnownSurface()
OPTICAL, AFM, FINE = (300e-6, 192), (30e-6, 192), (2.5e-6, 192)


def spectrum(surface, name, cut_off=(0.0, "")):
    return ScanSpectrum.of(level(surface, "curvature"), 2, name, cut_off)


def three(seed=0, **optical):
    return [
        spectrum(KNOWN.scan(*OPTICAL, 10 * seed + 1, **optical), "optical"),
        spectrum(KNOWN.scan(*AFM, 10 * seed + 2), "afm"),
        spectrum(KNOWN.scan(*FINE, 10 * seed + 3), "fine"),
    ]


def off_by(joined, longest):
    """ln of the density, relative to the true one, of waves up to `longest`."""
    q = joined.wave_number
    inside = (joined.at(q) > 0) & (q >= 2 * np.pi / longest)
    return np.log(joined.density[inside] / KNOWN.density(q[inside])), joined.error[inside]


@pytest.fixture(scope="module")
def joined():
    return join(three())


def test_several_places_give_the_spectrum():
    scans = [replace(scan, name=f"{scan.name} {k}") for k in range(5) for scan in three(k)]
    joined = join(scans)
    off, _ = off_by(joined, OPTICAL[0] / 8)
    assert np.sqrt(np.mean(off**2)) < 0.05
    assert np.abs(off).max() < 0.15
    slope = joined.slope(joined.shortest, joined.longest)
    assert slope == approx(KNOWN.slope(joined.shortest, joined.longest), rel=0.05)


@pytest.mark.parametrize("seed", range(3))
def test_the_spectrum_of_one_scan_each_is_within_its_error(seed):
    joined = join(three(seed))
    off, error = off_by(joined, OPTICAL[0])
    assert np.mean(np.abs(off) < 2 * error) > 0.9
    assert joined.slope(joined.shortest, joined.longest) == approx(
        KNOWN.slope(joined.shortest, joined.longest), rel=0.05
    )


def test_what_a_scan_measures_of_long_waves_is_that_of_random_surfaces():
    """White noise: levelling and tapers leave 70 % of the longest waves."""
    grid = Grid((48, 48), (1.0, 1.0))
    measured = np.mean(
        [
            power_spectral_density(level(Surface(white_noise((48, 48), k), grid), "curvature"))
            for k in range(150)
        ],
        axis=0,
    )
    k, _, weights = response.of_map(1.0, 2)
    for number, modes in ((1.0, [(0, 1), (1, 0)]), (2.0, [(0, 2), (2, 0)])):
        expected = weights[np.argmin(np.abs(k - number))].sum()
        assert np.mean([measured[mode] for mode in modes]) == approx(expected, rel=0.12)


@pytest.mark.parametrize("seed", range(3))
def test_smoothing_of_a_coarse_scan_is_cut_off(seed):
    joined = join(three(seed, smoothing=0.6e-6))
    coarse = next(scan for scan in joined.scans if scan.name == "optical")
    assert 8e-6 < coarse.shortest < 20e-6
    assert any("optical is smoothed below" in note for note in joined.notes)
    off, error = off_by(joined, OPTICAL[0] / 3)
    assert np.mean(np.abs(off) < 2 * error) > 0.9


def test_noise_of_a_coarse_scan_is_cut_off():
    joined = join(three(1, noise=60e-9))
    assert any("optical has noise below" in note for note in joined.notes)
    off, error = off_by(joined, OPTICAL[0] / 3)
    assert np.mean(np.abs(off) < 2 * error) > 0.9


def test_smoothing_of_the_finest_scan_is_undecidable(joined):
    assert any("whether fine is smoothed" in note for note in joined.notes)
    stated = [*three()[:2], spectrum(KNOWN.scan(*FINE, 3), "fine", (60e-9, "stated resolution"))]
    other = join(stated)
    assert not any("whether fine is smoothed" in note for note in other.notes)
    assert other.shortest == approx(60e-9)


def test_a_fine_scan_below_a_coarse_one_is_undecidable():
    optical, afm, _ = three()
    blurred = spectrum(KNOWN.scan(*FINE, 3, smoothing=0.15e-6), "fine")
    noted = join([optical, afm, blurred]).doubts
    assert any("smooth the latter cannot be decided" in note for note in noted)


def test_line_scans_join_height_maps():
    scans = [spectrum(KNOWN.line(300e-6, 3000, k), f"stylus {k}") for k in range(4)]
    joined = join([*scans, *three()[1:]])
    off, error = off_by(joined, 100e-6)
    assert np.mean(np.abs(off) < 2 * error) > 0.85
    off, _ = off_by(joined, 10e-6)
    assert np.sqrt(np.mean(off**2)) < 0.15


def test_line_scans_alone_give_the_spectrum_of_the_surface():
    joined = join([spectrum(KNOWN.line(100e-6, 4000, k), f"stylus {k}") for k in range(6)])
    off, error = off_by(joined, 50e-6)
    assert np.mean(np.abs(off) < 2 * error) > 0.9
    off, _ = off_by(joined, 2e-6)
    assert abs(off.mean()) < 0.06


def test_contradicting_scans_are_refused():
    optical, afm, fine = three()
    with pytest.raises(SurfaceError, match=r"^optical and afm: contradict each other: .* times"):
        join([optical, replace(afm, density=4 * afm.density), fine])
    with pytest.raises(SurfaceError, match=r"units that differ by 10\^3; correct the unit"):
        join([optical, replace(afm, density=1e6 * afm.density), fine])


def test_a_difference_of_calibration_is_part_of_the_error():
    optical, afm, fine = three()
    plain = join([optical, afm, fine])
    off = join([optical, replace(afm, density=1.6 * afm.density), fine])
    at = np.argmin(np.abs(plain.wave_number - 2 * np.pi / 3e-6))
    (before, *_), (after, *_) = plain.overlaps, off.overlaps
    assert after.ratio == approx(before.ratio / 1.6, rel=0.02)
    assert off.error[at] > plain.error[at] + 0.1


def test_scans_without_overlap_are_refused_or_bridged():
    optical, _, fine = three()
    with pytest.raises(SurfaceError, match=r"optical and fine: do not overlap: .*; add a scan"):
        join([optical, fine])
    joined = join([optical, fine], bridge=True)
    ((shortest, longest),) = joined.gaps
    assert (shortest, longest) == approx((1.25e-6, 3.125e-6))
    middle = np.argmin(np.abs(joined.wave_number - 2 * np.pi / 2e-6))
    ends = [np.argmin(np.abs(joined.wave_number - 2 * np.pi / wave)) for wave in (0.3e-6, 8e-6)]
    assert joined.error[middle] > joined.error[ends].max()


def test_a_scan_without_waves_is_not_used():
    optical, afm, fine = three()
    joined = join([optical, afm, fine.cut(2e-6, "tip radius")])
    assert any(note.startswith("fine is not used: its tip radius") for note in joined.doubts)
    with pytest.raises(SurfaceError, match="leaves no waves"):
        join([fine.cut(2e-6, "tip radius")])


def test_a_tip_is_seen_where_summits_have_half_its_curvature():
    """z = a cos(kx): summits of the second difference have the curvature a k² at small steps."""
    x = np.arange(400) * 1e-9
    k, a = 2 * np.pi / 100e-9, 1e-9
    surface = Surface(np.repeat(a * np.cos(k * x)[:, None], 20, axis=1), Grid((400, 20), 1e-9))
    assert tip_cut_off(surface, 0.4 / (a * k**2)) == 0.0
    radius = 1.0 / (a * k**2)
    cut = tip_cut_off(surface, radius)
    d = 0.5 * cut
    assert 2 * a * (1 - np.cos(k * d)) / d**2 == approx(0.5 / radius, rel=0.1)


@pytest.mark.parametrize("spacing", [2e-6, 100e-9, 10e-9])
def test_a_twin_of_any_size_has_the_joined_spectrum(joined, spacing):
    grid = Grid((160, 160), (spacing, spacing))
    made = twin_of_scans(joined, grid, seed=1)
    shortest = max(2 * spacing, joined.shortest)
    longest = min(joined.longest, 16 * grid.size[0])
    assert rms_slope(made) == approx(joined.slope(shortest, longest), rel=0.15)
    assert made.provenance["longest_wave_m"] == approx(longest)


def test_longer_waves_than_the_grid_curve_it(joined):
    grid = Grid((64, 64), (50e-9, 50e-9))
    plain = [twin_of_scans(joined, grid, seed=k, periodic=True) for k in range(12)]
    whole = [twin_of_scans(joined, grid, seed=k) for k in range(12)]
    assert all(is_periodic(made) for made in plain)
    assert not any(is_periodic(made) for made in whole)
    rms = [np.sqrt(np.mean([np.var(one.height) for one in ones])) for ones in (plain, whole)]
    assert rms[1] > 1.2 * rms[0]
    q = wave_numbers(grid.nodes, grid.spacing)
    power = joined.at(q.ravel()).sum() / (grid.size[0] * grid.size[1])
    assert rms[0] == approx(np.sqrt(power), rel=0.02)


def test_a_twin_has_the_heights_of_the_scan_that_carries_them():
    optical, *finer = three()
    skewed = replace(optical.surface, height=np.exp(optical.surface.height / 150e-9) * 100e-9)
    carrying = spectrum(skewed, "optical")
    joined = join([carrying, *finer])
    made = twin_of_scans(joined, Grid((192, 192), (2e-6, 2e-6)), seed=1)
    assert made.provenance["heights_of"] == "optical"
    assert describe(made)["Ssk"] > 0.5 * describe(skewed)["Ssk"] > 0.5


def test_unmeasured_waves_are_named_with_their_slope(joined):
    told = twin_of_scans(joined, Grid((64, 64), (1e-6, 1e-6)), seed=1).provenance["information"]
    assert "waves below 26.04 nm were not measured" in told
    assert "have an rms slope of" in told


def test_cells_above_all_waves_are_refused(joined):
    with pytest.raises(SurfaceError, match="cannot resolve any wave"):
        twin_of_scans(joined, Grid((8, 8), (200e-6, 200e-6)), seed=1)


def test_a_raised_spectrum_is_higher_by_its_error(joined):
    raised = joined.raised(2.0)
    assert np.log(raised.density / joined.density) == approx(2 * joined.error)


def test_small_and_flat_scans_are_refused():
    small = Surface(np.random.default_rng(0).normal(size=(8, 8)), Grid((8, 8), (1e-6, 1e-6)))
    with pytest.raises(SurfaceError, match=r"^small: has fewer than 16 pixels"):
        spectrum(small, "small")
    flat = Surface(np.ones((32, 32)), Grid((32, 32), (1e-6, 1e-6)))
    with pytest.raises(SurfaceError, match=r"^flat: is flat"):
        ScanSpectrum.of(flat, -1, "flat")


def test_the_predicted_scatter_is_that_between_places():
    edges, sets = (150e-6, 15e-6), range(12)
    sets = [
        join([spectrum(KNOWN.scan(edge, 64, 100 * k + i), f"{i}") for i, edge in enumerate(edges)])
        for k in sets
    ]
    q, common = sets[0].wave_number, [np.log(one.density) for one in sets]
    observed = np.std(common, axis=0, ddof=1)
    for waves in ranges(sets[0], 0.0, 1.0)[:4]:
        at = np.geomspace(2 * np.pi / waves[1], 2 * np.pi / waves[0], 33)
        actual = np.sqrt(np.mean(np.interp(np.log(at), np.log(q), observed) ** 2))
        predicted = np.sqrt(np.mean([scatter_in(one, waves) ** 2 for one in sets]))
        assert 0.5 < actual / predicted < 1.6
        assert scatter_in(sets[0], waves, 4) < 0.9 * scatter_in(sets[0], waves)


def test_waves_that_scatter_are_named_with_the_number_of_places(joined):
    scattered = list(scatter_between_places(joined, 0.0, 1.0))
    longest = scattered[0]
    assert longest.longest == approx(OPTICAL[0], rel=1e-9)
    assert longest.scan == "optical"
    assert longest.scatter > 0.2
    assert all(one.places is None or one.places > 1 for one in scattered)
    made = twin_of_scans(joined, Grid((96, 96), (3e-6, 3e-6)), 1)
    information = made.provenance["information"]
    assert f"between places of the surface, C scatters by {longest.scatter:.0%} from" in information
    assert "places like optical)" in information


def test_scans_of_many_places_scatter_little():
    scans = [replace(scan, name=f"{scan.name} {k}") for k in range(16) for scan in three(k)]
    assert list(scatter_between_places(join(scans), 0.0, OPTICAL[0] / 8)) == []


@pytest.mark.parametrize("cut", [slice(None), slice(20, 90)])
def test_two_scans_of_one_place_are_refused(cut):
    """A copy, or a part of a scan; levelling them differently hides nothing."""
    surface = KNOWN.scan(*AFM, 2)
    part = surface.height[cut, cut]
    grid = Grid(part.shape, surface.grid.spacing)
    tilted = part + 0.3 * grid.x[:, None] + 1e-6
    again = spectrum(Surface(tilted, grid), "again")
    with pytest.raises(SurfaceError, match="afm and again: show the same place"):
        join([*three(), again])


def test_two_places_with_the_same_pixels_are_joined():
    join([*three(), spectrum(KNOWN.scan(*AFM, 99), "other")])
    lines = [spectrum(KNOWN.line(30e-6, 300, seed), f"line {seed}") for seed in (1, 2)]
    join([*three(), *lines])
    with pytest.raises(SurfaceError, match="line 1 and copy: show the same place"):
        join([*three(), lines[0], replace(lines[0], name="copy")])


@pytest.mark.parametrize("turned", [np.rot90, np.transpose, np.flipud])
def test_a_turned_scan_gives_the_same_spectrum(turned):
    optical, _, fine = three()
    surface = KNOWN.scan(*AFM, 2)
    spectra = [
        join([optical, spectrum(Surface(np.ascontiguousarray(z), surface.grid), "afm"), fine])
        for z in (surface.height, turned(surface.height))
    ]
    assert spectra[1].density == approx(spectra[0].density, rel=1e-9)


@pytest.mark.parametrize("slope", [(0.5, -0.2), (0.0, 0.4)])
def test_tilt_is_no_wave(slope):
    optical, _, fine = three()
    surface = KNOWN.scan(*AFM, 2)
    x, y = surface.grid.x[:, None], surface.grid.y[None, :]
    tilted = Surface(surface.height + slope[0] * x + slope[1] * y, surface.grid)
    spectra = [join([optical, spectrum(one, "afm"), fine]) for one in (surface, tilted)]
    assert spectra[1].density == approx(spectra[0].density, rel=1e-6)


@pytest.mark.parametrize("width", [1, 6])
def test_filled_pixels_are_part_of_the_error(width):
    """Interpolated pixels have no short waves."""
    surface = KNOWN.scan(*FINE, 3)
    rng = np.random.default_rng(2)
    hole = np.zeros(surface.height.shape, bool)
    while hole.mean() < 0.15:
        i, j = rng.integers(0, surface.height.shape[0] - width, 2)
        hole[i : i + width, j : j + width] = True
    height = fill_harmonically(np.where(hole, np.nan, surface.height), surface.grid.spacing)
    told = {"undefined_fraction": float(hole.mean())}
    less = spectrum(Surface(height, surface.grid, told), "fine")
    whole, joined = join(three()), join([*three()[:2], less])
    q = whole.wave_number
    fine = (whole.at(q) > 0) & (q > 2 * np.pi / 0.5e-6)
    lost = np.log(joined.density[fine] / whole.density[fine])
    assert lost.mean() < -0.03
    assert np.all(np.abs(lost) < 2 * joined.error[fine])
    assert joined.error[fine].mean() > 0.1 > whole.error[fine].mean()
    assert any(note.startswith("15% of fine is interpolated") for note in joined.notes)
