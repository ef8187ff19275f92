"""Damaged scans: refused in one plain line, or read with the shape of the undamaged one.

The seed of a damage is its number.
"""

import random
from pathlib import Path

import numpy as np
import pytest

from restitution import Body, Contact, Pair
from restitution.errors import SurfaceError
from restitution.runs.messages import input_warnings
from restitution.surfaces import read_surface

SAMPLES = Path(__file__).parents[3] / "shared" / "topographies"
DAMAGES = 12  # of all files together
SIZE = 10e-6, 10e-6
STEEL = Pair(*2 * [Body(500e-6, 210e9, 0.25)])


def own(folder):
    """Matrices of our own, one of each format."""
    height = 1e-8 * np.random.default_rng(1).standard_normal((60, 60)).cumsum(axis=0)
    np.save(folder / "a.npy", height)
    np.savez(folder / "a.npz", height=height, size=np.array(SIZE))
    np.savez_compressed(folder / "b.npz", height=height.astype(np.float32))
    rows = "\n".join(" ".join(f"{v:.5e}" for v in row) for row in height)
    sizes = "# Channel: a\n# Width: 10 um\n# Height: 10 um\n# Value units: m\n"
    (folder / "a.txt").write_text(sizes + rows + "\n")
    (folder / "b.txt").write_text(sizes + "# nx: 60\n# ny: 60\n" + rows + "\n")
    (folder / "a.csv").write_text(rows.replace(" ", ",") + "\n")
    return sorted(folder.iterdir())


def damaged(content, rng, *, text):
    """The bytes of a file that was cut, zeroed, flipped, or lost lines; and what was done."""
    data = bytearray(content)
    # Most of what there is to misread is at the beginning.
    at = rng.randrange(rng.choice([min(200, len(data)), min(5000, len(data)), len(data)]))
    how = rng.choice(["cut", "zero", "drop", "flip", "flip", "swap", "lines" if text else "flip"])
    if how == "cut":
        del data[at:]
    elif how in ("zero", "drop"):
        part = slice(at, min(len(data), at + rng.choice([1, 8, 512, 10**5])))
        data[part] = bytes(part.stop - part.start) if how == "zero" else b""
    elif how == "flip":
        for _ in range(rng.choice([1, 1, 4, 100])):
            data[rng.randrange(at, min(len(data), at + 1000))] ^= 1 << rng.randrange(8)
    elif how == "swap":
        half = bytes(data[at : at + 64])
        data[-64:] = half
    else:
        lines = content.splitlines(keepends=True)
        first = rng.randrange(5, len(lines))
        del lines[first : first + len(lines) // 20 + 2]
        return b"".join(lines), how
    return bytes(data), how


def honest(surface, whole, how):
    """Whether a damaged scan has the shape of the whole one, or is said to be stretched."""
    if not np.isfinite(surface.height).all():
        return False
    if surface.grid.nodes == whole.grid.nodes:
        return True
    # No reader can know how many lines a text had that does not say so: from 1 % on it is warned.
    hx, hy = surface.grid.spacing
    lines = input_warnings(Contact(STEEL, surface), 1e-9)
    warned = abs(hx / hy - 1) < 0.01 or any("not square" in line for line in lines)
    return warned and how in ("lines", "cut", "drop")


def read(path):
    sized = path.suffix in (".npy", ".csv") or path.name == "b.npz"
    return read_surface(path, size=SIZE if sized else None, undefined="interpolate")


def try_all(files, count, folder, within, plainly_refused):
    """Damage and read so many of `files` in turn; how many were refused, and how many read."""
    ends = {"refused": 0, "read": 0}
    whole = {file: read(file) for file in files}
    for number in range(count):
        rng, file = random.Random(number), files[number % len(files)]
        content, how = damaged(file.read_bytes(), rng, text=file.suffix in (".txt", ".csv"))
        path = folder / f"damaged{file.suffix}"
        path.write_bytes(content)
        try:
            with within(5):
                surface = read(path)
        except SurfaceError as error:
            assert plainly_refused(error), (number, file.name, how, str(error)[:300])  # noqa: PT017
            ends["refused"] += 1
        except Exception as error:
            raise AssertionError(f"{number}, {file.name}, {how}: {error!r}"[:1000]) from error
        else:
            assert honest(surface, whole[file], how), (number, file.name, how, surface.grid)
            ends["read"] += 1
    return ends


def test_matrices(fuzz, tmp_path, within, plainly_refused):
    (tmp_path / "whole").mkdir()
    files, count = own(tmp_path / "whole"), round(4 * DAMAGES * fuzz)
    ends = try_all(files, count, tmp_path, within, plainly_refused)
    print(ends)
    assert ends["refused"] > 0.2 * count


def test_files_of_formats_that_have_a_writer(fuzz, tmp_path, within, plainly_refused, write_scan):
    (tmp_path / "whole").mkdir()
    height = 1e-8 * np.random.default_rng(1).standard_normal((60, 60)).cumsum(axis=0)
    files = [
        write_scan(tmp_path / "whole" / f"a.{suffix}", height, SIZE)
        for suffix in ("x3p", "gwy", "nc", "txt", "sur", "tmd", "nid", "mi", "di")
    ]
    ends = try_all(files, round(DAMAGES * fuzz), tmp_path, within, plainly_refused)
    print(ends)
    assert ends["refused"] > 0


@pytest.mark.skipif(not SAMPLES.is_dir(), reason=f"the sample topographies are not at {SAMPLES}")
def test_files_of_instruments(fuzz, tmp_path, within, plainly_refused):
    pytest.importorskip("SurfaceTopography", reason="the extra 'measured' is not installed")
    files = [
        SAMPLES / name
        for name in ("di-3.di", "mi-1.mi", "nid-1.nid", "tmd-1.tmd", "sur-2.sur", "matrix-3.txt")
    ]
    ends = try_all(files, round(DAMAGES * fuzz), tmp_path, within, plainly_refused)
    print(ends)
    assert ends["refused"] > 0
