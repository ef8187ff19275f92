"""Read line scans: heights along a line, from text or an instrument's own format."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from restitution.display import quantity
from restitution.errors import SurfaceError, shown
from restitution.numerics.grid import Grid
from restitution.surfaces.reading.instrument_files import read_instrument_line
from restitution.surfaces.reading.scan import decode, in_metres
from restitution.surfaces.reading.text_files import TEXT_SUFFIXES
from restitution.surfaces.surface import Array, Surface

_LEAST = 16  # points of a line
_LARGEST_STEP = 20.0  # of neighbouring points, in mean steps; a larger one is a missing part
_UNDEFINED = 0.2  # largest fraction of undefined points
_TALLEST = 10.0  # largest span of heights, in lengths of the line
_SEPARATOR = re.compile(r"[;,\s]+")


def read_line(
    path: Path, *, unit: str | None = None, size: float | None = None, channel: int | None = None
) -> Surface:
    """Read a line scan as a surface with one pixel along y.

    Text has a position and a height on each line, or a height alone. Uneven points are interpolated
    linearly at their mean step; the provenance states the largest (`largest_step_m`).

    Args:
        path: File to read.
        unit: Unit of heights, and of positions unless `size` is given; needed for text.
        size: Length of the line (m); replaces the positions in the file.
        channel: Number of the channel of an instrument's file.

    Returns:
        Heights (m), shape (n, 1); undefined points are interpolated.

    Raises:
        SurfaceError: The file or an argument cannot be used.
    """
    own = None if path.suffix.lower() in TEXT_SUFFIXES else read_instrument_line(path, channel)
    if own is not None:
        x, z, stated = own
        per_metre = 1.0 if stated else _factor(path, unit)
        x, z = x * per_metre, z * per_metre
    else:
        along, z = _columns(path)
        scale = _factor(path, unit)
        z = z * scale
        if along is None and size is None:
            raise SurfaceError(
                f"{path}: has heights without positions; give the length of the line",
                argument="size",
            )
        x = np.arange(z.size, dtype=float) if along is None else along * scale
    return _even(path, x, z, size)


def _factor(path: Path, unit: str | None) -> float:
    scale = None if unit is None else in_metres(1.0, unit)
    if scale is None:
        raise SurfaceError(
            f"{path}: is a line scan that does not state its unit; give the unit of its positions "
            'and heights, such as "um"',
            argument="height_unit",
        )
    return scale


def _columns(path: Path) -> tuple[Array | None, Array]:
    rows: list[list[float]] = []
    for number, line in enumerate(decode(path.read_bytes()).splitlines(), 1):
        text = line.strip()
        if not text or text.startswith("#"):
            continue
        fields = [field for field in _SEPARATOR.split(text) if field]
        try:
            row = [float(field) for field in fields]
        except ValueError:
            if not rows:
                continue  # a header
            raise SurfaceError(
                f"{path}: line {number}, {shown(text, 20)}, is not a point of the line scan, so "
                "the file is damaged; export it again"
            ) from None
        if len(row) > 2 or (rows and len(row) != len(rows[0])):
            raise SurfaceError(
                f"{path}: line {number} has {len(row)} values, but a point of a line scan has a "
                "position and a height; export it again"
            )
        rows.append(row)
    values = np.array(rows, dtype=np.float64)
    if len(rows) < _LEAST:
        raise SurfaceError(f"{path}: has {len(rows)} points, but a line scan needs {_LEAST}")
    return (None, values[:, 0]) if values.shape[1] == 1 else (values[:, 0], values[:, 1])


def _even(path: Path, x: Array, z: Array, size: float | None) -> Surface:
    defined = np.isfinite(x) & np.isfinite(z)
    if defined.sum() < max(_LEAST, (1 - _UNDEFINED) * z.size):
        raise SurfaceError(
            f"{path}: {z.size - int(defined.sum())} of {z.size} points are undefined; measure again"
        )
    missing, n = z.size - int(defined.sum()), int(np.isfinite(x).sum())
    mean = float(np.ptp(x[np.isfinite(x)])) / (n - 1)
    x, z = x[defined], z[defined]
    if x[-1] < x[0]:
        x, z = x[::-1], z[::-1]
    steps = np.diff(x)
    if not (steps > 0).all():
        raise SurfaceError(
            f"{path}: its positions do not increase along the line; export a profile without "
            "overhangs"
        )
    if steps.max() > _LARGEST_STEP * mean:
        raise SurfaceError(
            f"{path}: no points from {x[steps.argmax()]:.4g} to {x[steps.argmax() + 1]:.4g} m; "
            "give the parts before and after as two files"
        )
    scale = 1.0 if size is None else size / (n * mean)
    at = x[0] + mean * np.arange(n)
    h = mean * scale
    if np.ptp(z) > _TALLEST * n * h:
        raise SurfaceError(
            f"{path}: its heights span {quantity(float(np.ptp(z)), 'm')} on a line of "
            f"{quantity(n * h, 'm')}, so positions and heights have different units; give the unit "
            "of the heights, and the length of the line as size",
            argument="height_unit",
        )
    return Surface(
        np.interp(at, x, z)[:, None],
        Grid((n, 1), (h, h)),
        {
            "source": "measured",
            "kind": "line scan",
            "file": str(path),
            "size_x_m": n * h,
            "pixel_x_m": h,
            "largest_step_m": float(steps.max()) * scale,
            "undefined_pixels": missing,
        },
    )
