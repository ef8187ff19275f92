"""Height maps in NumPy and text files, which need no optional package."""

import os
import pickle
import sys

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from restitution.errors import SurfaceError
from restitution.surfaces import Surface, read_surface
from tolerance import approx

SIZE = (10e-6, 4e-6)
# Heights that differ between all pixels, 5 along x and 4 along y, without symmetry.
RAMP = 1e-9 * (10.0 * np.arange(5)[:, None] + np.arange(4)[None, :])


@pytest.fixture(autouse=True)
def _without_surface_topography(monkeypatch):
    """These formats must give the same results and errors without the optional extra."""
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)


def save(path, array, **kwargs):
    np.save(path, array, **kwargs)
    return path


def test_npy_axes_and_spacing(tmp_path):
    surface = read_surface(save(tmp_path / "ramp.npy", RAMP), size=SIZE)
    np.testing.assert_array_equal(surface.height, RAMP)
    assert surface.grid.nodes == (5, 4)
    assert surface.grid.spacing == approx((2e-6, 1e-6), rel=1e-15)


@pytest.mark.parametrize(
    "array",
    [
        np.asfortranarray(RAMP),
        RAMP.astype(np.float32),
        RAMP.astype(">f8"),
        RAMP.astype(np.longdouble),
        np.arange(20, dtype=np.int16).reshape(5, 4) // 100,
    ],
    ids=["fortran", "float32", "big-endian", "longdouble", "int16"],
)
def test_npy_number_types(tmp_path, array):
    surface = read_surface(save(tmp_path / "ramp.npy", array), size=SIZE)
    assert surface.height.dtype == np.dtype("=f8")
    np.testing.assert_allclose(surface.height, array.astype(float), rtol=1e-15)


def test_heights_are_read_into_memory(tmp_path):
    path = save(tmp_path / "ramp.npy", RAMP)
    height = read_surface(path, size=SIZE).height
    save(path, -RAMP)
    np.testing.assert_array_equal(height, RAMP)


def test_npz_takes_height_or_the_only_array(tmp_path):
    np.savez(tmp_path / "named.npz", other=np.zeros(3), height=RAMP)
    np.savez_compressed(tmp_path / "only.npz", z=RAMP, size=np.array(SIZE))
    named = read_surface(tmp_path / "named.npz", size=SIZE)
    only = read_surface(tmp_path / "only.npz")
    np.testing.assert_array_equal(named.height, RAMP)
    np.testing.assert_array_equal(only.height, RAMP)
    assert only.grid == named.grid
    assert only.provenance["channel_name"] == "z"


def test_npz_that_leaves_the_choice_open(refusal, tmp_path):
    np.savez(tmp_path / "two.npz", a=RAMP, b=RAMP)
    assert "arrays a, b, but not 'height'" in refusal(tmp_path / "two.npz", size=SIZE)


def test_npz_size_must_be_two_numbers(refusal, tmp_path):
    np.savez(tmp_path / "ramp.npz", height=RAMP, size=np.array([1e-5]))
    assert "array 'size' has shape (1,)" in refusal(tmp_path / "ramp.npz")
    np.savez(tmp_path / "nan.npz", height=RAMP, size=np.array([1e-5, np.nan]))
    assert "not two positive lengths" in refusal(tmp_path / "nan.npz")


@pytest.mark.parametrize(
    ("array", "reason"),
    [
        (np.zeros(20), "shape (20,)"),
        (np.zeros((3, 4, 5)), "shape (3, 4, 5)"),
        (np.zeros((1, 20)), "shape (1, 20)"),
        (np.zeros((0, 4)), "shape (0, 4)"),
        (np.float64(3.0), "shape ()"),
        (RAMP + 1j, "complex128"),
        (RAMP > 0, "bool"),
        (RAMP.astype(str), "<U32"),
        (np.zeros((5, 4), dtype=[("z", float)]), "not real numbers"),
    ],
)
def test_npy_that_is_no_height_map(refusal, tmp_path, array, reason):
    assert reason in refusal(save(tmp_path / "array.npy", array), size=SIZE)
    np.savez(tmp_path / "array.npz", height=array)
    assert reason in refusal(tmp_path / "array.npz", size=SIZE)


class Malicious:
    """Creates a file when unpickled."""

    def __init__(self, victim):
        self.victim = victim

    def __reduce__(self):
        return os.mkdir, (str(self.victim),)


def test_pickles_are_refused_and_never_run(refusal, tmp_path):
    victim = tmp_path / "victim"
    poison = np.full((4, 4), Malicious(victim), dtype=object)
    pickle.loads(pickle.dumps(Malicious(victim)))
    assert victim.exists(), "the poison must be real for this test to mean anything"
    victim.rmdir()

    save(tmp_path / "object.npy", poison, allow_pickle=True)
    np.savez(tmp_path / "object.npz", height=poison)
    for suffix in (".npy", ".npz"):
        (tmp_path / f"raw{suffix}").write_bytes(pickle.dumps(Malicious(victim)))
    for name in ("object.npy", "object.npz", "raw.npy", "raw.npz"):
        assert "pickled objects, which are never loaded" in refusal(tmp_path / name, size=SIZE)
        assert not victim.exists()


@pytest.mark.parametrize("suffix", [".npy", ".npz"])
def test_damaged_numpy_files(refusal, tmp_path, suffix):
    whole = tmp_path / f"whole{suffix}"
    np.savez(whole, height=RAMP) if suffix == ".npz" else np.save(whole, RAMP)
    content = whole.read_bytes()
    damaged = tmp_path / f"damaged{suffix}"
    for length in (1, 5, 40, 100, len(content) - 1):
        damaged.write_bytes(content[:length])
        assert refusal(damaged, size=SIZE).startswith("is not a plain NumPy file")


def test_header_that_promises_more_than_memory_holds(refusal, tmp_path):
    path = save(tmp_path / "ramp.npy", RAMP)
    path.write_bytes(path.read_bytes().replace(b"(5, 4), }", b"(5000000000, 4000000000), }"))
    assert "5000000000 x 4000000000 values, more than the" in refusal(path, size=SIZE)


@pytest.mark.parametrize("suffix", [".npy", ".npz", ".txt", ".csv"])
@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_any_damage_gives_a_surface_or_one_error(tmp_path, suffix, data):
    path = tmp_path / f"fuzz{suffix}"
    if suffix == ".npy":
        np.save(path, RAMP)
    elif suffix == ".npz":
        np.savez(path, height=RAMP)
    else:
        np.savetxt(path, RAMP, delimiter="," if suffix == ".csv" else " ")
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content)
    try:
        surface = read_surface(path, size=SIZE)
    except SurfaceError as error:
        assert "\n" not in str(error)  # noqa: PT017
    else:
        assert isinstance(surface, Surface)


@pytest.mark.parametrize(
    ("name", "separator"),
    [
        ("a.txt", " "),
        ("a.dat", "\t"),
        ("a.csv", ","),
        ("a.csv", ";"),
        ("a.asc", "  "),
        ("A.CSV", ", "),
    ],
)
def test_text_lines_are_scan_lines(write, tmp_path, name, separator):
    """Lines of text are y and columns are x, so the array is the transpose of the text."""
    lines = [separator.join(f"{z:.12e}" for z in line) for line in RAMP.T]
    path = write(tmp_path / name, "# made for a test\n" + "\n".join(lines) + "\n")
    surface = read_surface(path, size=SIZE)
    np.testing.assert_allclose(surface.height, RAMP, rtol=1e-11)
    assert surface.grid.spacing == approx((2e-6, 1e-6), rel=1e-15)
    assert surface.height.flags.c_contiguous


def test_text_trailing_separators_and_blank_lines(write, tmp_path):
    path = write(tmp_path / "a.csv", "\ufeff1e-9,2e-9,3e-9,4e-9,\r\n\r\n5e-9,6e-9,7e-9,8e-9,\r\n")
    expected = 1e-9 * np.array([[1, 5], [2, 6], [3, 7], [4, 8]])
    np.testing.assert_allclose(read_surface(path, size=SIZE).height, expected, rtol=1e-15)


def test_decimal_commas_between_semicolons(write, tmp_path):
    path = write(tmp_path / "a.csv", "1,5e-9;2e-9;3e-9;4e-9\n5e-9;6e-9;7e-9;8,25e-9\n")
    height = read_surface(path, size=SIZE).height
    assert (height[0, 0], height[3, 1]) == approx((1.5e-9, 8.25e-9), rel=1e-15)


def test_decimal_commas_between_tabs(write, tmp_path):
    path = write(tmp_path / "a.txt", "1,5e-9\t2,5e-9\t3,5e-9\t-4,5e-9\n" * 4)
    assert read_surface(path, size=SIZE).height[:, 0] == approx((1.5e-9, 2.5e-9, 3.5e-9, -4.5e-9))


HEADER = "# Channel: Height\n# Width: 10.00 µm\n# Height: 4 {um}\n# Value units: nm\n"
MATRIX = "0 10 20 30 40\n1 11 21 31 41\n2 12 22 32 42\n3 13 23 33 43\n"
MATRIX_IN_METRES = MATRIX.replace(" ", "e-9 ").replace("\n", "e-9\n")


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
@pytest.mark.parametrize("micrometre", ["µm", "um", "e-3 mm"])
def test_text_header_gives_size_and_unit(write, tmp_path, encoding, micrometre):
    text = HEADER.replace(" {um}", micrometre) + MATRIX
    surface = read_surface(write(tmp_path / "a.txt", text, encoding))
    np.testing.assert_allclose(surface.height, RAMP, rtol=1e-12)
    assert surface.grid.spacing == approx((2e-6, 1e-6), rel=1e-15)
    assert surface.provenance["channel_name"] == "Height"


def test_text_header_size_is_exact(write, tmp_path):
    surface = read_surface(write(tmp_path / "a.txt", HEADER.replace("{um}", "um") + MATRIX))
    assert (surface.provenance["size_x_m"], surface.provenance["size_y_m"]) == (1e-5, 4e-6)


def test_greek_mu_is_a_micro_sign(write, tmp_path):
    text = HEADER.replace("{um}", "\N{GREEK SMALL LETTER MU}m") + MATRIX
    assert read_surface(write(tmp_path / "a.txt", text)).grid.spacing[1] == approx(1e-6)


def test_size_repeats_or_replaces_the_header(write, tmp_path):
    path = write(tmp_path / "a.txt", HEADER.replace("{um}", "um") + MATRIX)
    assert read_surface(path, size=(10.000001e-6, 4e-6)).provenance["size_x_m"] == 1e-5
    surface = read_surface(path, size=(10.0001e-6, 4e-6))
    assert surface.provenance["size_x_m"] == 10.0001e-6
    said = "10 x 4 um according to the file; it is read as 10.0001 x 4 um, because 'size' says so"
    assert said in surface.provenance["notice"]


def test_header_with_one_side_only(write, refusal, tmp_path):
    path = write(tmp_path / "a.txt", "# Width: 10 um\n" + MATRIX_IN_METRES)
    assert "does not contain the size" in refusal(path)
    notice = read_surface(path, size=(20e-6, 4e-6)).provenance["notice"]
    assert "10 x ? um according to the file; it is read as 20 x 4 um, because" in notice
    assert read_surface(path, size=SIZE).grid.spacing == approx((2e-6, 1e-6))


def test_values_that_are_no_lengths(write, refusal, tmp_path):
    path = write(tmp_path / "a.txt", HEADER.replace("nm", "deg").replace("{um}", "um") + MATRIX)
    assert 'values are in "deg", which is not a unit of length' in refusal(path)


@pytest.mark.parametrize(
    "line",
    ["# z-unit: nm", "# Einheiten: nm", "# Breite: 10 µm", "# Bit2nm = 0.01", "# x-pixels=5"],
)
def test_headers_that_set_scales_unknown_here_are_not_guessed_at(write, refusal, tmp_path, line):
    path = write(tmp_path / "a.txt", f"{line}\n{MATRIX}")
    message = refusal(path, size=SIZE)
    assert "may set an unknown unit or scale" in message
    assert 'pip install "SurfaceTopography>=1.27"' in message


def test_other_comments_are_only_comments(write, tmp_path):
    text = "# sample: steel ball\n# seed = 42\n#\n# plain words\n" + MATRIX_IN_METRES
    assert read_surface(write(tmp_path / "a.txt", text), size=SIZE).grid.nodes == (5, 4)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("# only a comment\n", "holds no numbers"),
        ("   \n\n", "holds no numbers"),
        ("1e-9 2e-9 3e-9 4e-9\n1e-9 2e-9\n", "line 2 has 2 values, but the first line has 4"),
        ("1e-9\n2e-9\n3e-9\n", "3 lines of 1 values are a profile or a list of coordinates"),
        ("0 0 1e-9\n0 1 2e-9\n1 0 1e-9\n1 1 2e-9\n", "list of coordinates"),
        ("1e-9 2e-9 3e-9 4e-9 5e-9\n", "a profile"),
        ("x0,x1,x2,x3\n1,2,3,4\n", "line 1 holds 'x0', which is not a number"),
        (
            "1 2 3 4\n\n5 6 7 8j\n",
            'line 3, "5 6 7 8j", is not a scan line of 4 values like the others',
        ),
    ],
)
def test_text_that_is_no_height_map(write, refusal, tmp_path, text, reason):
    assert reason in refusal(write(tmp_path / "a.txt", text), size=SIZE)


def test_binary_content_under_a_text_name(refusal, tmp_path):
    path = tmp_path / "a.dat"
    path.write_bytes(bytes(range(256)) * 4)
    assert "which is not a number" in refusal(path, size=SIZE)


def test_missing_size_is_asked_for(refusal, tmp_path):
    message = refusal(save(tmp_path / "ramp.npy", RAMP))
    assert "such as size=(10e-6, 10e-6)" in message


@pytest.mark.parametrize("size", [(0.0, 1e-5), (1e-5, -1e-5), (np.nan, 1e-5), (1e-5, np.inf)])
def test_sizes_that_are_no_lengths(tmp_path, size):
    with pytest.raises(SurfaceError, match=r"^size: .* m are not two positive lengths; "):
        read_surface(save(tmp_path / "ramp.npy", RAMP), size=size)


@pytest.mark.parametrize("channel", [1, -1])
def test_one_channel_is_all_there_is(refusal, tmp_path, channel):
    path = save(tmp_path / "ramp.npy", RAMP)
    assert f"there is no channel {channel}" in refusal(path, size=SIZE, channel=channel)
    np.testing.assert_array_equal(read_surface(path, size=SIZE, channel=0).height, RAMP)


def test_heights_in_another_unit_are_noticed(refusal, tmp_path):
    path = save(tmp_path / "micrometres.npy", 1e6 * RAMP + 1e3 * RAMP.T[0, 0] + np.eye(5, 4))
    assert "cannot be in metres" in refusal(path, size=SIZE)


def test_undefined_pixels(refusal, tmp_path):
    height = np.tile(RAMP, (4, 5))
    height[3, 4], height[7, 7] = np.nan, np.inf
    path = save(tmp_path / "holes.npy", height)
    message = refusal(path, size=SIZE)
    assert "2 of 400 pixels (0.50%) are undefined" in message
    assert 'undefined="interpolate"' in message
    surface = read_surface(path, size=SIZE, undefined="interpolate")
    defined = np.isfinite(height)
    np.testing.assert_array_equal(surface.height[defined], height[defined])
    assert surface.height[3, 4] == approx(
        np.average(height[[2, 4, 3, 3], [4, 4, 3, 5]], weights=[4, 4, 25, 25]), rel=1e-12
    )
    assert surface.provenance["undefined_pixels"] == 2
    assert surface.provenance["undefined_fraction"] == 0.005
    assert surface.provenance["undefined_treatment"] == "interpolated harmonically"


def test_undefined_fields_of_text(write, refusal, tmp_path):
    rows = [[f"{z:.3e}" for z in line] for line in np.tile(RAMP, (2, 2)).T]
    rows[1][3], rows[2][5], rows[5][5] = "", "bad", "NaN"
    path = write(tmp_path / "a.csv", "\n".join(",".join(row) for row in rows))
    assert "3 of 80 pixels" in refusal(path, size=SIZE)


@pytest.mark.parametrize("undefined", ["error", "interpolate"])
def test_too_many_undefined_pixels(refusal, tmp_path, undefined):
    height = np.tile(RAMP, (2, 5))
    height[:5, :9] = np.nan
    path = save(tmp_path / "holes.npy", height)
    assert "45 of 200 pixels (22.5%)" in refusal(path, size=SIZE, undefined=undefined)
    save(path, np.full((5, 4), np.nan))
    assert "20 of 20 pixels (100.0%)" in refusal(path, size=SIZE, undefined=undefined)


def test_unknown_treatment_of_undefined_pixels(tmp_path):
    with pytest.raises(SurfaceError, match=r"^undefined='zero' is unknown; "):
        read_surface(save(tmp_path / "ramp.npy", RAMP), size=SIZE, undefined="zero")


def test_files_that_cannot_be_opened(write, refusal, tmp_path):
    assert "there is no such file" in refusal(tmp_path / "none.npy")
    assert "is a directory" in refusal(tmp_path)
    assert "is empty" in refusal(write(tmp_path / "empty.npy", ""))
    assert "is empty" in refusal(write(tmp_path / "empty.sur", ""))
    with pytest.raises(SurfaceError, match="cannot be opened"):
        read_surface("null\0byte.npy")


def test_provenance(tmp_path):
    import hashlib

    path = save(tmp_path / "ramp.npy", RAMP)
    provenance = read_surface(str(path), size=SIZE).provenance
    assert provenance["file"] == str(path)
    assert provenance["file_sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()
    assert provenance["source"] == "measured"
    assert provenance["format"] == "npy"
    assert provenance["undefined_pixels"] == 0
    assert {type(value) for value in provenance.values()} <= {str, float, int}


def test_other_formats_need_the_extra(write, refusal, tmp_path):
    message = refusal(write(tmp_path / "scan.sur", "DIGITAL SURF"))
    assert message == (
        "reading this format needs the SurfaceTopography package; install the readers with "
        '`pip install "SurfaceTopography>=1.27"` (the extra "measured")'
    )
