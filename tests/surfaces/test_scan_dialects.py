"""Dialects of scan files: what is read, and what is refused for its own reason."""

import numpy as np
import pytest

import instrument_formats as formats
from restitution.surfaces import read_surface
from tolerance import approx

SIZE = 8e-6, 9e-6
X, Y = np.meshgrid(np.arange(16.0), np.arange(12.0), indexing="ij")
HEIGHT = 1e-9 * (100 * X + 10 * Y**2 + 3 * X * Y - 1171)


def matrix(heights=1e9 * HEIGHT, separator="\t"):
    return "\n".join(separator.join(f"{v:.9g}" for v in row) for row in heights.T) + "\n"


HEADER = "# Width: 8 µm\n# Height: 9 µm\n# Value units: nm\n"


def same(path, **arguments):
    """Read the file, and compare it with the heights written."""
    surface = read_surface(path, **arguments)
    assert surface.grid.size == approx(SIZE, rel=1e-6)
    np.testing.assert_allclose(surface.height, HEIGHT, rtol=1e-6, atol=4e-11)
    return surface


@pytest.fixture
def write_sur(tmp_path):
    pytest.importorskip("SurfaceTopography", reason="the extra 'measured' is not installed")

    def call(*names, **changes):
        path = tmp_path / "a.sur"
        content = b""
        for number, name in enumerate(names or ("scan",)):
            formats.write_sur(path, (1 + number) * HEIGHT, SIZE)
            content += formats.sur_dialect(path.read_bytes(), name, **changes)
        path.write_bytes(content)
        return path

    return call


@pytest.mark.parametrize("top", [0, 7])
def test_nanofocus_spacing_is_in_nanometres(tmp_path, top):
    """The first byte of the heights decides whether the reader of MATLAB accepts the file."""
    formats.write_nms(tmp_path / "a.nms", HEIGHT + top * 1e-6, SIZE)
    surface = read_surface(tmp_path / "a.nms")
    assert surface.grid.size == approx(SIZE, rel=1e-12)
    np.testing.assert_allclose(surface.height, HEIGHT + top * 1e-6, atol=5e-11)


@pytest.mark.parametrize("flag", [0, 1])
@pytest.mark.parametrize("mult", ["7\t4\t2", "6\t2\t2", None])
@pytest.mark.parametrize("before", ["", "Intensity"])
def test_wyko_text(tmp_path, flag, mult, before):
    formats.write_wyko(tmp_path / "a.asc", HEIGHT, SIZE, flag=flag, mult=mult, other=before)
    same(tmp_path / "a.asc")


@pytest.mark.parametrize("dialect", ["bISO-1.0", "bISO-2.0", "bBCR-1.0", "aISO-1.0", "aBCR-1.0"])
@pytest.mark.parametrize("kind", [4, 5, 6, 7, 3])
def test_sdf_marks_of_missing_points(tmp_path, refusal, dialect, kind):
    path = tmp_path / "a.sdf"
    step = 8e-8 if kind == 4 else 1e-9
    formats.write_sdf(path, HEIGHT, SIZE, dialect=dialect, kind=kind, step=step)
    surface = read_surface(path, undefined="interpolate")
    assert surface.provenance["undefined_pixels"] == 0
    np.testing.assert_allclose(surface.height, HEIGHT, atol=0.51 * step)
    height = HEIGHT.copy()
    height[3, 4] = np.nan
    formats.write_sdf(path, height, SIZE, dialect=dialect, kind=kind, step=step)
    assert refusal(path).startswith("1 of 192 pixels (0.52%) are undefined")


@pytest.mark.parametrize(
    "changes", [{}, {"compressed": True}, {"unit": "µm".encode()}, {"unit": b"\xb5m"}]
)
def test_digital_surf(write_sur, changes):
    same(write_sur(**changes))


def test_the_surfaces_of_a_digital_surf_file_are_its_channels(write_sur, refusal):
    path = write_sur("before", "after", compressed=True)
    provenance = same(path).provenance
    assert (provenance["channel"], provenance["channel_name"]) == (0, "before")
    assert provenance["other_height_channels"] == "1 ('after')"
    np.testing.assert_allclose(read_surface(path, channel=1).height, 2 * HEIGHT, atol=2e-10)
    assert refusal(path, channel=2).startswith("there is no channel 2; choose from 0 ('before')")


def test_digital_surf_without_heights(write_sur, refusal):
    assert refusal(write_sur(kind=14)).startswith("holds force curves, not a height map; ")
    said = "contains no height map (channels: 0 ('scan', values in V)); "
    assert refusal(write_sur(unit=b"V")).startswith(said)


def test_damaged_compressed_digital_surf(write_sur, refusal):
    path = write_sur(compressed=True)
    path.write_bytes(path.read_bytes()[:-30])
    assert refusal(path).startswith("is a compressed Digital Surf file whose heights are damaged")


@pytest.mark.parametrize("comment", [b"", b"Created by TrueMap v6\r\n", 80 * b"x"])
def test_truemap_comment_of_any_length(tmp_path, comment):
    pytest.importorskip("SurfaceTopography", reason="the extra 'measured' is not installed")
    formats.write_tmd(tmp_path / "a.tmd", HEIGHT, SIZE, comment=comment)
    same(tmp_path / "a.tmd")


@pytest.mark.parametrize("dash", "-\u2013\u2014\u2212")
@pytest.mark.parametrize("folder", ["", "scan/"])
def test_x3p_dashes_and_folders(tmp_path, dash, folder):
    pytest.importorskip("SurfaceTopography", reason="the extra 'measured' is not installed")
    formats.write_x3p(tmp_path / "a.x3p", HEIGHT, SIZE, dash=dash, folder=folder)
    same(tmp_path / "a.x3p")


def test_x3p_profile(tmp_path, refusal):
    formats.write_x3p(tmp_path / "a.x3p", HEIGHT, SIZE, feature="PRF")
    assert refusal(tmp_path / "a.x3p").startswith("is a line scan (a profile of 16 points)")


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16", "utf-8-sig"])
@pytest.mark.parametrize("comma", [False, True])
def test_text_encodings_and_decimal_commas(write, tmp_path, encoding, comma):
    body = matrix().replace(".", ",") if comma else matrix()
    same(write(tmp_path / "a.txt", HEADER + body, encoding))


@pytest.mark.parametrize("corner", ["0", "", "nan", "y/x"])
def test_axes_of_a_matrix(write, refusal, tmp_path, corner):
    x, y = (0.5 * X[:, 0], 0.75 * Y[0])
    lines = matrix(separator=",").splitlines()
    text = ",".join([corner, *(f"{v:g}" for v in x)]) + "\n"
    text += "\n".join(f"{v:g},{line}" for v, line in zip(y, lines, strict=True))
    path = write(tmp_path / "a.csv", text)
    steps = "steps of 0.5 along x and 0.75 along y"
    assert steps in refusal(path)
    surface = same(path, size=SIZE, height_unit="nm")
    assert "are taken for the axes of x and y" in surface.provenance["notice"]


def test_a_plane_has_no_axes(write, tmp_path):
    plane = 100 * X + 10 * Y
    path = write(tmp_path / "a.txt", HEADER + matrix(plane))
    assert read_surface(path).grid.nodes == (16, 12)


def test_two_columns_are_a_line_scan(write, refusal, tmp_path):
    pytest.importorskip("SurfaceTopography", reason="the extra 'measured' is not installed")
    text = "x in um,z in um\n" + "".join(f"{0.5 * i},{0.1 * i**2}\n" for i in range(40))
    assert refusal(write(tmp_path / "a.csv", text)).startswith("is a line scan (a profile of 40")


@pytest.mark.parametrize("unit", ["nm", "um", "µm", "mm", "Å"])
@pytest.mark.parametrize("suffix", ["csv", "npy"])
def test_height_unit(write, tmp_path, unit, suffix):
    per_metre = {"nm": 1e9, "um": 1e6, "µm": 1e6, "mm": 1e3, "Å": 1e10}[unit]
    path = tmp_path / f"a.{suffix}"
    if suffix == "npy":
        np.save(path, per_metre * HEIGHT)
    else:
        write(path, matrix(per_metre * HEIGHT, ";"))
    surface = same(path, size=SIZE, height_unit=unit)
    assert surface.provenance["height_unit"] == unit
    assert "notice" not in surface.provenance


def test_height_unit_replaces_the_file(write, tmp_path):
    path = write(tmp_path / "a.txt", HEADER.replace("nm", "um") + matrix())
    notice = same(path, height_unit="nm").provenance["notice"]
    assert "the heights are in um according to the file; they are read in nm" in notice


def test_height_unit_of_a_file_without_one(tmp_path):
    pytest.importorskip("SurfaceTopography", reason="the extra 'measured' is not installed")
    from scipy.io import savemat

    savemat(tmp_path / "a.mat", {"z": 1e9 * HEIGHT})
    same(tmp_path / "a.mat", size=SIZE, height_unit="nm")


def test_height_unit_must_be_a_length(write, tmp_path):
    with pytest.raises(ValueError, match="height_unit: 'V' is not a unit of length; give m, mm"):
        read_surface(write(tmp_path / "a.txt", matrix()), size=SIZE, height_unit="V")


def test_heights_taller_than_the_scan(write, refusal, tmp_path):
    path = write(tmp_path / "a.txt", matrix(1e3 * HEIGHT))
    span = np.ptp(1e3 * HEIGHT)
    notice = read_surface(path, size=(0.9 * span,) * 2).provenance["notice"]
    assert "are taller than the scan is wide; set height_unit = " in notice
    assert 'cannot be in metres; set height_unit = "um"' in refusal(path, size=SIZE)


def test_heights_below_a_picometre(write, refusal, tmp_path):
    path = write(tmp_path / "a.txt", matrix(1e-7 * HEIGHT))
    assert "are lower than any instrument measures; set height_unit" in refusal(path, size=SIZE)
    surface = read_surface(path, size=SIZE, height_unit="m")
    assert "are lower than any instrument measures" in surface.provenance["notice"]


@pytest.mark.parametrize("size", ["160 m", "2000 mm", "20 mm"])
def test_sizes_that_cannot_be(write, refusal, tmp_path, size):
    """Edges of metres, and pixels above a millimetre."""
    edge = f"# Width: {size}\n# Height: {size}\n# Value units: nm\n"
    path = write(tmp_path / "a.txt", edge + matrix())
    assert "is larger than instruments take; give its edge lengths" in refusal(path)
    assert same(path, size=SIZE)
    surface = read_surface(path, size=(0.02, 0.02))
    assert "correct size, unless it is right" in surface.provenance["notice"]


def test_the_part_that_is_used_may_be_complete(tmp_path, refusal):
    height = np.tile(HEIGHT, (4, 4))
    height[np.hypot(*np.meshgrid(np.arange(-24, 24), np.arange(-32, 32))) > 28] = np.nan
    np.save(tmp_path / "a.npy", height)
    size = (64e-6, 48e-6)
    assert "undefined, more than the 20%" in refusal(tmp_path / "a.npy", size=size)
    within = (-10e-6, 10e-6), (-10e-6, 10e-6)
    surface = read_surface(tmp_path / "a.npy", size=size, within=within)
    np.testing.assert_array_equal(surface.height, height[22:43, 14:35])
    assert surface.provenance["undefined_pixels"] == 0
    assert surface.provenance["size_x_m"] == approx(21e-6)
