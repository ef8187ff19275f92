"""Instrument formats through SurfaceTopography, and the sample topographies."""

import importlib.util
import logging
import pickle
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from restitution.errors import SurfaceError
from restitution.surfaces import describe, level, read_surface
from tolerance import approx

SAMPLES = Path(__file__).parents[2].parent / "shared" / "topographies"
needs_readers = pytest.mark.skipif(
    importlib.util.find_spec("SurfaceTopography") is None,
    reason="SurfaceTopography (the extra 'measured') is not installed",
)
needs_samples = pytest.mark.skipif(
    not SAMPLES.is_dir(), reason=f"the sample topographies are not at {SAMPLES}"
)


@needs_readers
@needs_samples
@pytest.mark.parametrize(
    ("name", "nodes", "size", "rms", "rms_levelled", "channel_name"),
    [
        ("mi-1.mi", (256, 256), (20e-6, 20e-6), 33.22e-9, 3.434e-9, "Topography"),
        ("nid-1.nid", (256, 256), (20e-6, 20e-6), 239.6e-9, 7.112e-9, "Scan forward (Z-Axis)"),
        ("di-3.di", (256, 256), (10e-6, 10e-6), 226.4e-9, 35.22e-9, "ZSensor"),
        ("matrix-3.txt", (256, 256), (10e-6, 10e-6), 35.22e-9, 35.22e-9, "ZSensor"),
        ("sur-2.sur", (563, 484), (1.961492e-3, 1.686256e-3), 17.70e-9, 17.29e-9, "Default"),
        ("tmd-1.tmd", (300, 300), (18.9566e-3, 18.9566e-3), 74.34e-6, 74.34e-6, "Default"),
    ],
)
def test_samples(name, nodes, size, rms, rms_levelled, channel_name):
    surface = read_surface(SAMPLES / name, undefined="interpolate")
    assert surface.grid.nodes == nodes
    assert surface.grid.size == approx(size, rel=1e-6)
    assert describe(surface)["Sq_m"] == approx(rms, rel=1e-3)
    assert describe(level(surface, "tilt"))["Sq_m"] == approx(rms_levelled, rel=1e-3)
    assert surface.provenance["channel_name"] == channel_name
    assert {type(value) for value in surface.provenance.values()} <= {str, float, int}


@needs_readers
@needs_samples
def test_the_same_scan_in_two_formats():
    """di-3, read by SurfaceTopography and levelled, equals matrix-3, read by this package."""
    di = level(read_surface(SAMPLES / "di-3.di"), "tilt").height.ravel()
    text = read_surface(SAMPLES / "matrix-3.txt").height
    assert np.corrcoef(di, text.ravel())[0, 1] > 0.999
    for other in (text.T, text[::-1], text[:, ::-1], text[::-1, ::-1]):
        assert np.corrcoef(di, other.ravel())[0, 1] < 0.5


@needs_readers
@needs_samples
def test_native_text_reader_agrees_with_surface_topography():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from SurfaceTopography import read_topography

        theirs = read_topography(str(SAMPLES / "matrix-3.txt")).to_unit("m")
    ours = read_surface(SAMPLES / "matrix-3.txt")
    np.testing.assert_array_equal(ours.height, theirs.heights())
    assert ours.grid.size == approx(theirs.physical_sizes, rel=1e-14)


@needs_readers
@needs_samples
def test_another_height_channel_can_be_chosen():
    height = read_surface(SAMPLES / "di-3.di", channel=3)
    assert height.provenance["channel"] == 3
    assert height.provenance["channel_name"] == "Height"
    assert describe(height)["Sq_m"] == approx(264.0e-9, rel=1e-3)


@needs_readers
@needs_samples
@pytest.mark.parametrize(
    ("name", "arguments", "expected"),
    [
        (
            "mi-1.mi",
            {"channel": 1},
            "channel 1 ('Deflection', values in V) is not a height map that can be converted to "
            "metres; choose a height channel: 0 ('Topography')",
        ),
        (
            "di-3.di",
            {"channel": 1},
            "channel 1 ('AmplitudeError', values in no stated unit) is not a height map that can "
            "be converted to metres; choose a height channel: 0 ('ZSensor'), 3 ('Height')",
        ),
        (
            "di-3.di",
            {"channel": 4},
            "there is no channel 4; choose from 0 ('ZSensor'), 1 ('AmplitudeError'), 2 ('Phase'), "
            "3 ('Height')",
        ),
        ("mi-1.mi", {"channel": -1}, "there is no channel -1; choose from 0 ('Topography'), "),
        ("matrix-3.txt", {"channel": 1}, "there is no channel 1; "),
        (
            "sur-2.sur",
            {},
            "117 of 272492 pixels (0.04%) are undefined; give undefined="
            '"interpolate" to fill them from their neighbours, or crop the file',
        ),
        (
            "di_corrupted.di",
            {},
            "is damaged or incomplete (File is not large enough to contain all data buffers); "
            "export it again, or export it as a text matrix of heights",
        ),
        (
            "nonsense_txt_file.txt",
            {},
            "line 1 holds 'This', which is not a number; give a matrix of heights in metres, with "
            "comments after #",
        ),
        ("README.md", {}, "is damaged, or not a topography in a format known to Surface"),
    ],
)
def test_samples_refused(name, arguments, expected, refusal):
    assert refusal(SAMPLES / name, **arguments).startswith(expected)


@needs_readers
@needs_samples
def test_a_size_that_repeats_the_file_is_accepted():
    surface = read_surface(SAMPLES / "nid-1.nid", size=(20.000001e-6, 20e-6))
    assert surface.grid.size == approx((20e-6, 20e-6), rel=1e-12)


@needs_readers
@needs_samples
@pytest.mark.parametrize("name", ["mi-1.mi", "nid-1.nid", "di-3.di", "sur-2.sur", "tmd-1.tmd"])
@pytest.mark.parametrize("share", [0.001, 0.05, 0.6, 0.99])
def test_truncated_instrument_files(tmp_path, name, share, refusal):
    """A truncated file raises an error, unless the channel itself is complete."""
    content = (SAMPLES / name).read_bytes()
    path = tmp_path / name
    path.write_bytes(content[: int(share * len(content))])
    try:
        height = read_surface(path, undefined="interpolate").height
    except SurfaceError:
        refusal(path, undefined="interpolate")
    else:
        assert share > 0.5
        whole = read_surface(SAMPLES / name, undefined="interpolate").height
        np.testing.assert_array_equal(height, whole)


@needs_readers
@needs_samples
def test_readers_leave_the_terminal_alone(capfd):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for path in sorted(SAMPLES.iterdir()):
            try:
                read_surface(path)
            except SurfaceError:
                continue
    assert not caught
    assert capfd.readouterr() == ("", "")


@needs_readers
def test_text_of_other_programs_is_handed_over(tmp_path):
    """The texts are Gwyddion's in German, SPIP's, and a list of coordinates with units."""
    matrix = "0 10 20 30 40\n1 11 21 31 41\n2 12 22 32 42\n3 13 23 33 43\n"
    expected = 1e-9 * (10.0 * np.arange(5)[:, None] + np.arange(4)[None, :])
    german = "# Kanal: z\n# Breite: 10 µm\n# Höhe: 4 µm\n# Einheiten: nm\n" + matrix
    spip = (
        "# File Format = ASCII\n# x-pixels = 5\n# y-pixels = 4\n# x-length = 10000\n"
        "# y-length = 4000\n# z-unit = nm\n" + matrix
    )
    coordinates = "# Lateral units: um\n# Value units: nm\n" + "".join(
        f"{2 * i} {j} {10 * i + j}\n" for j in range(4) for i in range(5)
    )
    for text in (german, spip, coordinates):
        path = tmp_path / "a.txt"
        path.write_text(text, encoding="utf-8")
        surface = read_surface(path)
        np.testing.assert_allclose(surface.height, expected, rtol=1e-12, atol=1e-20)
        assert surface.grid.spacing == approx((2e-6, 1e-6))
        assert surface.provenance["format"].startswith("SurfaceTopography ")


@needs_readers
def test_heights_without_a_unit_are_not_guessed_at(tmp_path, refusal):
    from scipy.io import savemat

    savemat(tmp_path / "a.mat", {"z": np.ones((6, 6))})
    message = refusal(tmp_path / "a.mat", size=(1e-5, 1e-5))
    assert "values in no stated unit" in message
    assert "numpy.save" in message


@needs_readers
@pytest.mark.parametrize("suffix", [".pkl", ".dat", ".bin"])
def test_pickles_are_not_run_by_any_reader(tmp_path, suffix, refusal):
    class Malicious:
        def __reduce__(self):
            return Path.mkdir, (tmp_path / "victim",)

    path = tmp_path / f"a{suffix}"
    path.write_bytes(pickle.dumps(Malicious()))
    refusal(path)
    assert not (tmp_path / "victim").exists()


class FakeTopography:
    """Heights 1, 2, … in `unit`, on pixels of size 1 unless the file has a size."""

    def __init__(self, unit, physical_sizes, scale=1.0):
        self.unit, self.physical_sizes, self.scale = unit, physical_sizes, scale

    def to_unit(self, unit):
        assert unit == "m"
        factor = {"um": 1e-6, "nm": 1e-9}[self.unit]
        return FakeTopography("m", [factor * side for side in self.physical_sizes], factor)

    def heights(self):
        return self.scale * np.arange(1.0, 21.0).reshape(5, 4)


def fake_channel(name, **changes):
    """A channel as in SurfaceTopography: a height map in nm, 2 x 1 um large."""
    channel = SimpleNamespace(
        name=name,
        index=0,
        dim=2,
        nb_grid_pts=(5, 4),
        physical_sizes=(2000.0, 1000.0),
        unit="nm",
        data_unit="nm",
        is_height_channel=True,
    )
    channel.topography = lambda physical_sizes: FakeTopography(
        channel.unit, channel.physical_sizes or physical_sizes
    )
    vars(channel).update(changes)
    return channel


@pytest.fixture
def fake_file(tmp_path, monkeypatch):
    """Make a file in which SurfaceTopography finds the given channels."""

    def make(*channels, version="1.27.1", default=0):
        def open_topography(path):
            print("reading", path)
            print("reading", path, file=sys.stderr)
            warnings.warn("this is deprecated", DeprecationWarning, stacklevel=1)
            logging.getLogger("SurfaceTopography.IO").warning("odd header")
            for index, channel in enumerate(channels):
                channel.index = index
            return SimpleNamespace(
                channels=list(channels),
                default_channel=channels[default] if channels else None,
                close=lambda: closed.append(path),
            )

        closed = []
        module = SimpleNamespace(__version__=version, open_topography=open_topography)
        monkeypatch.setitem(sys.modules, "SurfaceTopography", module)
        path = tmp_path / "scan.xyz"
        path.write_text("anything")
        return path, closed

    return make


def test_unit_and_size_become_metres(fake_file, capfd):
    path, closed = fake_file(fake_channel("z"))
    surface = read_surface(path)
    np.testing.assert_allclose(surface.height, 1e-9 * np.arange(1.0, 21.0).reshape(5, 4))
    assert surface.grid.spacing == approx((0.4e-6, 0.25e-6), rel=1e-15)
    assert surface.provenance["file_unit"] == "nm"
    assert closed == [str(path)]
    assert capfd.readouterr() == ("", "")


def test_size_is_needed_where_the_file_has_none(fake_file, refusal):
    path, _ = fake_file(fake_channel("z", physical_sizes=None))
    assert "size=(10e-6, 10e-6)" in refusal(path)
    assert read_surface(path, size=(1e-5, 2e-5)).grid.spacing == approx((2e-6, 5e-6))


def test_default_channel_that_is_no_height_map_is_passed_over(fake_file):
    phase = fake_channel("Phase", data_unit="deg", is_height_channel=False)
    path, _ = fake_file(phase, fake_channel("z"))
    provenance = read_surface(path).provenance
    assert provenance["channel_name"] == "z"
    assert "other_height_channels" not in provenance


def test_default_channel_is_the_readers(fake_file):
    path, _ = fake_file(fake_channel("trace"), fake_channel("retrace"), default=1)
    provenance = read_surface(path).provenance
    assert (provenance["channel"], provenance["channel_name"]) == (1, "retrace")
    assert provenance["other_height_channels"] == "0 ('trace')"


@pytest.mark.parametrize(
    "changes",
    [
        {"data_unit": "A", "is_height_channel": False},  # ampere, not ångström
        {"unit": ("um", "V")},
        {"unit": "V", "data_unit": "V"},
    ],
)
def test_file_without_a_height_map(fake_file, changes, refusal):
    path, _ = fake_file(fake_channel("odd", **changes))
    unit = changes.get("data_unit") or "V"
    said = f"contains no height map (channels: 0 ('odd', values in {unit})); export "
    assert refusal(path).startswith(said)
    assert refusal(path, channel=0).startswith(f"channel 0 ('odd', values in {unit}) is not a ")


def test_a_map_without_a_unit_needs_one(fake_file, refusal):
    path, _ = fake_file(fake_channel("odd", unit=None, data_unit=None))
    assert refusal(path).startswith("channel 0 ('odd', values in no stated unit) may hold heights")


def test_profiles_are_called_line_scans(fake_file, refusal):
    path, _ = fake_file(fake_channel("odd", dim=1))
    assert refusal(path).startswith("is a line scan (a profile of 5 points), not a height map; ")


def test_maps_of_the_feedback_are_not_offered(fake_file):
    names = "Deflection", "ZSensor", "Amplitude retrace", "Error", "Height"
    path, _ = fake_file(*map(fake_channel, names))
    provenance = read_surface(path).provenance
    assert provenance["channel_name"] == "ZSensor"
    assert provenance["other_height_channels"] == "4 ('Height')"
    assert read_surface(path, channel=0).provenance["channel_name"] == "Deflection"


def test_a_file_without_channels(fake_file, refusal):
    path, _ = fake_file()
    assert refusal(path).startswith("contains no height map (channels: none; perhaps the file is ")


def test_failure_while_reading_is_one_error(fake_file, refusal):
    def fail(physical_sizes):
        raise ZeroDivisionError("no pixels\nat all")

    path, closed = fake_file(fake_channel("z", topography=fail))
    assert refusal(path).startswith("its heights cannot be read (no pixels); ")
    assert closed


def test_versions_that_misread_files_are_refused(fake_file, refusal):
    path, _ = fake_file(fake_channel("z"), version="1.25.0")
    message = refusal(path)
    assert "needs SurfaceTopography 1.27 or later, but 1.25.0 is installed" in message
