"""Formats written by SurfaceTopography or by the tests: reading returns the heights written."""

import warnings

import numpy as np
import pytest

from instrument_formats import HALF_RANGE
from restitution.errors import SurfaceError
from restitution.surfaces import read_surface
from tolerance import approx

SIZE = 20e-6, 7e-6
HEIGHT = 1e-9 * np.random.default_rng(1).standard_normal((40, 28)).cumsum(axis=0)
EXACT = ["x3p", "gwy", "nc", "txt"]
ROUNDED = ["sur", "tmd", "nid", "mi", "di"]  # sizes in 32-bit floats, heights in 16-bit integers
HEIGHT_STEP = np.abs(HEIGHT).max() / HALF_RANGE


@pytest.fixture(params=EXACT + ROUNDED)
def path(request, tmp_path):
    return tmp_path / f"scan.{request.param}"


@pytest.fixture
def rounding(path):
    """The largest relative error of sizes and the largest error of heights (m) of the format."""
    return (1e-7, 0.5001 * HEIGHT_STEP) if path.suffix[1:] in ROUNDED else (1e-12, 1e-20)


def test_heights_size_and_axes_are_those_written(write_scan, path, rounding):
    surface = read_surface(write_scan(path, HEIGHT, SIZE))
    assert surface.grid.nodes == HEIGHT.shape
    assert surface.grid.size == approx(SIZE, rel=rounding[0])
    np.testing.assert_allclose(surface.height, HEIGHT, rtol=1e-12, atol=rounding[1])
    assert {type(value) for value in surface.provenance.values()} <= {str, float, int}


@pytest.mark.parametrize("path", [*EXACT, "sur"], indirect=True)
def test_undefined_pixels_are_filled_only_on_request(write_scan, path, rounding, refusal):
    height = HEIGHT.copy()
    height[3, 4] = height[20, 9] = np.nan
    write_scan(path, height, SIZE)
    how = "masked in the file" if path.suffix == ".gwy" else "undefined"
    assert refusal(path).startswith(f"2 of 1120 pixels (0.18%) are {how}; give undefined=")
    filled = read_surface(path, undefined="interpolate").height
    known = ~np.isnan(height)
    np.testing.assert_allclose(filled[known], HEIGHT[known], rtol=1e-12, atol=rounding[1])
    assert np.isfinite(filled).all()


def test_a_size_repeats_or_replaces_the_file(write_scan, path):
    write_scan(path, HEIGHT, SIZE)
    assert read_surface(path, size=(20.000001e-6, 7e-6)).grid.size == approx(SIZE, rel=1e-6)
    surface = read_surface(path, size=(20e-6, 8e-6))
    assert surface.grid.size == approx((20e-6, 8e-6), rel=1e-15)
    said = "the scan is 20 x 7 um according to the file; it is read as 20 x 8 um, because 'size'"
    # Some formats store the size in 32-bit floats, so its last digits differ.
    assert said in surface.provenance["notice"] or path.suffix in (".sur", ".tmd")
    assert "according to the file" in surface.provenance["notice"]


@pytest.mark.parametrize("path", ["mi", "di"], indirect=True)
def test_a_channel_is_chosen_from_those_of_heights(write_scan, path, rounding, refusal):
    heights = {".mi": "0 ('Topography')", ".di": "0 ('ZSensor'), 2 ('Height')"}[path.suffix]
    write_scan(path, HEIGHT, SIZE)
    assert refusal(path, channel=1).endswith(
        " is not a height map that can be converted to metres; choose a height channel: " + heights
    )
    assert refusal(path, channel=3).startswith("there is no channel 3; choose from 0 ('")
    if path.suffix == ".di":
        twice = read_surface(path, channel=2)
        assert (twice.provenance["channel"], twice.provenance["channel_name"]) == (2, "Height")
        np.testing.assert_allclose(twice.height, 2 * HEIGHT, rtol=1e-12, atol=2 * rounding[1])


@pytest.mark.parametrize("path", [*EXACT, "sur", "tmd", "nid"], indirect=True)
@pytest.mark.parametrize("channel", [1, -1])
def test_there_is_one_channel(write_scan, path, refusal, channel):
    write_scan(path, HEIGHT, SIZE)
    assert refusal(path, channel=channel).startswith(f"there is no channel {channel}; ")


@pytest.mark.parametrize("share", [0.001, 0.05, 0.6, 0.99])
def test_a_truncated_file_is_refused(write_scan, path, refusal, share):
    content = write_scan(path, HEIGHT, SIZE).read_bytes()
    whole = read_surface(path).height
    path.write_bytes(content[: int(share * len(content))])
    if path.suffix == ".mi" and share > 0.5:  # the second channel is truncated, not the first
        np.testing.assert_array_equal(read_surface(path).height, whole)
    else:
        refusal(path)


def test_readers_leave_the_terminal_alone(write_scan, path, capfd):
    content = write_scan(path, HEIGHT, SIZE).read_bytes()
    capfd.readouterr()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        read_surface(path)
        path.write_bytes(content[: len(content) // 20])
        with pytest.raises(SurfaceError):
            read_surface(path)
    assert not caught
    assert capfd.readouterr() == ("", "")
