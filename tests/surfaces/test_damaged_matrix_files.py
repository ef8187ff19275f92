"""Damaged, incomplete and hostile height files raise an error and are never read as complete."""

import contextlib
import io
import os
import sys
import time
import zipfile

import numpy as np
import pytest

from restitution.errors import SurfaceError
from restitution.surfaces import read_surface

SIZE = (10e-6, 4e-6)


@pytest.fixture(autouse=True)
def _without_surface_topography(monkeypatch):
    """These formats must give the same results and errors without the optional extra."""
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)


ROWS = [
    " ".join(f"{1e-9 * v:.4e}" for v in row) for row in np.random.default_rng(1).normal(size=(9, 6))
]
SIZES = "# Channel: a\n# Width: 10 um\n# Height: 15 um\n"


@pytest.mark.parametrize("number", [0, 4, 8])
@pytest.mark.parametrize("damage", ["@@@", "1.0 2.0 x 4 5 6 z", "q.5 2 3 4 5 6"])
@pytest.mark.parametrize("header", [SIZES, ""])
def test_a_damaged_scan_line_is_not_left_out(write, refusal, tmp_path, number, damage, header):
    # The readers of SurfaceTopography skip such lines, so the file must not be passed to them.
    rows = [*ROWS]
    rows[number] = damage
    path = write(tmp_path / "a.txt", header + "\n".join(rows))
    if number == 0 and damage == "@@@" and not header:
        assert "line 1 holds '@@@'" in refusal(
            path, size=SIZE
        )  # possibly the heading of another format
        return
    assert "is not a scan line of 6 values like the others" in refusal(path, size=(1e-5, 1.5e-5))


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("# ny: 10\n", "its header states 10 lines, but the file has 9 lines of 6 values"),
        ("# nx = 7\n", "its header states 7 values, but the file has 9 lines of 6 values"),
        ("# Pixels: 6 x 12\n", "its header states 12 lines"),
    ],
)
def test_lines_that_are_missing_by_the_header(write, refusal, tmp_path, header, words):
    path = write(tmp_path / "a.txt", SIZES + header + "\n".join(ROWS))
    assert words in refusal(path)
    whole = SIZES + "# nx: 6\n# ny: 9\n# Pixels: 6 x 9\n" + "\n".join(ROWS)
    assert read_surface(write(tmp_path / "b.txt", whole)).grid.nodes == (6, 9)


def test_two_channels_are_not_taken_for_one(write, refusal, tmp_path):
    path = write(tmp_path / "a.txt", 2 * (SIZES + "\n".join(ROWS) + "\n"))
    assert "holds several channels" in refusal(path)


SPACES = 10**5 * " "


@pytest.mark.parametrize(
    "line", ["#" + SPACES, f"# unit{SPACES}x", f"# a: {10**5 * '1'} x y", "# a: 1" + SPACES]
)
def test_headers_of_many_spaces_are_read_at_once(write, tmp_path, line):
    path = write(tmp_path / "a.txt", line + "\n" + "\n".join(ROWS))
    began = time.perf_counter()
    with contextlib.suppress(SurfaceError):
        read_surface(path, size=SIZE)
    assert time.perf_counter() - began < 0.1


@pytest.mark.parametrize("suffix", ["npz", "npy"])
def test_a_small_file_of_a_huge_array_is_refused_by_its_header(refusal, tmp_path, suffix):
    path = tmp_path / f"a.{suffix}"
    if suffix == "npz":
        np.savez_compressed(path, height=np.zeros((2, 2)))
        content = io.BytesIO()
        np.lib.format.write_array_header_1_0(
            content, {"descr": "|b1", "fortran_order": False, "shape": (20000, 20000)}
        )
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("height.npy", content.getvalue())
    else:
        with path.open("wb") as stream:
            np.lib.format.write_array_header_1_0(
                stream, {"descr": "|b1", "fortran_order": False, "shape": (20000, 20000)}
            )
            stream.truncate(stream.tell() + 20000**2)  # a sparse file
    said = refusal(path, size=SIZE)
    assert "20000 x 20000 values, more than the 67108864 pixels that a scan may have" in said


def test_what_is_no_regular_file_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe.npy")
    for path in (tmp_path / "pipe.npy", "/dev/zero"):
        with pytest.raises(SurfaceError, match="is not a regular file"):
            read_surface(path, size=SIZE)


def test_a_sparse_file_of_gigabytes_is_refused_at_once(refusal, tmp_path):
    with (tmp_path / "a.txt").open("wb") as stream:
        stream.truncate(2**32)
    assert "has 4294967296 bytes" in refusal(tmp_path / "a.txt")


def test_a_name_too_long_for_a_file_is_shortened(tmp_path):
    with pytest.raises(SurfaceError, match="cannot be opened") as caught:
        read_surface(tmp_path / (5000 * "x"), size=SIZE)
    assert len(str(caught.value)) < 300
