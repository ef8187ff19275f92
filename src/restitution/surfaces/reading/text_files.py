"""Read height matrices from plain text; x runs along a line of the file, y from line to line."""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from restitution.errors import SurfaceError, shown
from restitution.surfaces.reading.numpy_files import SAVE_AS_NUMPY
from restitution.surfaces.reading.scan import Y_DOWN, Scan, decode, in_metres
from restitution.surfaces.surface import Array

TEXT_SUFFIXES = frozenset({".txt", ".csv", ".dat", ".asc"})

_LEAST_AXIS = 4  # smallest number of points of an axis
_EVEN = 1e-2  # largest relative difference between the steps of an axis, whose values are rounded
_LEAST_VALUES = 4  # smallest number of heights of a scan line; fewer values may be coordinates
_LONGEST = 200  # longer header values (in characters) are not read as a number with a unit
_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"
# A number with at most one comma, which is then its decimal sign, or a mark of an undefined pixel.
_DECIMAL_COMMA = re.compile(r"[-+]?\d+(?:,\d+)?(?:[eE][-+]?\d+)?|nan|bad", re.IGNORECASE)
_QUANTITY = re.compile(rf"(?P<number>{_NUMBER})\s*(?P<unit>\S+)")
# Header keys that set units or scales in files of other programs (SPIP, Nova, Gwyddion's XYZ).
_FOREIGN_KEY = re.compile(r"unit|length|pixel|bit2|file format|factor", re.IGNORECASE)
# Keys for the number of values per line (x) and for the number of lines (y).
_COLUMNS = frozenset({"nx", "columns", "values per line"})
_LINES = frozenset({"ny", "rows", "lines"})
_OWN_KEYS = frozenset({"width", "height", "value units"})
_BOTH = re.compile(r"(\d{1,9})\s{0,9}[x×,\s]\s{0,9}(\d{1,9})")
_STATEMENT = re.compile(r"#(?P<key>[^:=]*)[:=](?P<value>.*)")
_UNDEFINED = frozenset({"", "bad", "nan", "inf", "-inf", "infinite"})
_Counts = dict[str, int]


class NotAMatrixError(SurfaceError):
    """A text file that is not a plain matrix of heights, but may be an instrument's own format."""


def read_text(path: Path) -> Scan:
    """Read a matrix of heights (m), separated by white space, commas or semicolons.

    Comments start with #; `# Width:`, `# Height:`, `# Value units:`, `# nx:`, `# ny:`, `# Pixels:`
    and the like are checked. An empty field, `nan` or `bad` marks an undefined pixel. With
    semicolons, or white space around numbers with one comma each, the comma is the decimal sign.
    Axes in the first line and column are left out. Raises `NotAMatrixError` where another reader
    may understand the content, and `SurfaceError` for a matrix that is damaged or does not contain
    heights.
    """
    lines = [line.strip() for line in decode(path.read_bytes()).splitlines()]
    data = [(n, line) for n, line in enumerate(lines, 1) if line and not line.startswith("#")]
    if not data:
        raise SurfaceError(f"{path}: holds no numbers; {SAVE_AS_NUMPY}")
    comments = [line for line in lines if line.startswith("#")]
    plain = any(_statement(line)[0] in _OWN_KEYS for line in comments)
    rows = _parse_rows(path, data, plain=plain)
    width = len(rows[0])
    for (n, _), row in zip(data, rows, strict=True):
        if len(row) != width:
            raise SurfaceError(
                f"{path}: line {n} has {len(row)} values, but the first line has {width}, so the "
                "file is incomplete or not a matrix; export it again"
            )
    if width < _LEAST_VALUES or len(rows) < 2:
        raise NotAMatrixError(
            f"{path}: {len(rows)} lines of {width} values are a profile or a list of coordinates, "
            "not a height map; give a matrix with a scan line of at least 4 heights on each line"
        )
    size, metres_per_value, details, counts = _read_header(path, comments)
    values = np.array(rows, dtype=np.float64)
    axes = _axes_of(values)
    if axes is None and _has_text_corner(data[0][1]):
        raise _damaged(path, *data[0], width)
    if axes is not None:
        values, details = values[1:, 1:], {**details, "axes": axes.steps}
    _check_counts(path, counts, (values.shape[1], values.shape[0]))
    return Scan(
        np.ascontiguousarray(values.T) * metres_per_value,
        size,
        {"format": "text matrix", **Y_DOWN, **details},
        unit=str(details.get("file_unit", "m")),
        stated="file_unit" in details,
        notices=() if axes is None else (axes.notice(path),),
    )


def _parse_rows(path: Path, data: list[tuple[int, str]], *, plain: bool) -> list[list[float]]:
    """Parse all lines. Raise `SurfaceError` for damaged lines, `NotAMatrixError` for other text.

    Text after the first scan line is damage: other readers would silently skip it. Above, it is
    damage if the comments show a matrix (`plain`) or the line holds half as many numbers as a scan
    line.
    """
    rows: list[list[float]] = []  # a line of text becomes an empty row
    first: NotAMatrixError | None = None
    corner = _has_text_corner(data[0][1])
    for number, line in data:
        try:
            rows.append(_parse_row(path, number, line, corner=corner and not rows))
        except NotAMatrixError as error:
            rows.append([])
            first = first or error
    if first is None:
        return rows
    widths = [len(row) for row in rows if len(row) >= _LEAST_VALUES]
    usual = max(set(widths), key=widths.count) if widths else 0
    begin = next((i for i, row in enumerate(rows) if len(row) == usual), 0)
    for i, (row, (number, line)) in enumerate(zip(rows, data, strict=True)):
        if usual and not row and (plain or begin < i or _is_nearly_a_row(path, line, usual)):
            raise _damaged(path, number, line, usual)
    raise first


def _damaged(path: Path, number: int, line: str, usual: int) -> SurfaceError:
    return SurfaceError(
        f"{path}: line {number}, {shown(line, 20)}, is not a scan line of {usual} values like the "
        "others, so the file is damaged; export it again"
    )


def _is_nearly_a_row(path: Path, line: str, width: int) -> bool:
    numbers = 0
    for text in line.replace(";", " ").replace(",", " ").split():
        with suppress(NotAMatrixError):
            _parse_field(path, 0, text)
            numbers += 1
    return 2 * numbers >= width


def _has_text_corner(line: str) -> bool:
    """Whether `line` may be an axis: numbers after one field of text."""
    first, *others = _fields(line)
    numbers = all(re.fullmatch(_NUMBER, text.strip()) for text in others)
    return (
        numbers
        and len(others) >= _LEAST_VALUES
        and not re.fullmatch(_NUMBER, first.strip())
        and (first.strip().lower() not in _UNDEFINED)
    )


def _parse_row(path: Path, number: int, line: str, *, corner: bool = False) -> list[float]:
    fields = _fields(line)
    if corner:
        fields[0] = ""
    try:
        return [float(text) for text in fields]
    except ValueError:
        return [_parse_field(path, number, text.strip()) for text in fields]


def _fields(line: str) -> list[str]:
    if ";" in line:
        return line.replace(",", ".").removesuffix(";").split(";")
    fields = line.split()
    if "," in line and len(fields) > 1 and all(map(_DECIMAL_COMMA.fullmatch, fields)):
        return [field.replace(",", ".") for field in fields]
    return line.removesuffix(",").split(",") if "," in line else fields


def _parse_field(path: Path, number: int, text: str) -> float:
    if text.lower() in _UNDEFINED:
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise NotAMatrixError(
            f"{path}: line {number} holds {text[:20]!a}, which is not a number; give a matrix of "
            "heights in metres, with comments after #"
        ) from None


def _read_header(
    path: Path, comments: list[str]
) -> tuple[tuple[float | None, float | None], float, dict[str, str | float], _Counts]:
    """Edge lengths (m), metres per value, provenance, and counts of values and lines."""
    sides: dict[str, float] = {}
    metres_per_value = 1.0
    details: dict[str, str | float] = {}
    counts: _Counts = {}
    for comment in comments:
        key, value = _statement(comment)
        if stated := _counts(key, value):
            counts.update(stated)
            continue
        quantity = _QUANTITY.fullmatch(value) if len(value) <= _LONGEST else None
        number, unit = (float(quantity["number"]), quantity["unit"]) if quantity else (1.0, value)
        length = in_metres(number, unit)
        if key in ("width", "height") and quantity and length is not None:
            sides[key] = length
        elif key == "value units":
            if quantity or length is None:
                raise SurfaceError(
                    f"{path}: its values are in {shown(value)}, which is not a unit of length; "
                    "export the height channel instead"
                )
            metres_per_value, details["file_unit"] = length, value
        elif key == "channel":
            if "channel_name" in details:
                raise NotAMatrixError(
                    f"{path}: holds several channels; save the heights in a separate file"
                )
            details["channel_name"] = value
        elif length is not None or _FOREIGN_KEY.search(key):
            # A wrong guess of the unit could change heights by a factor of a million.
            raise NotAMatrixError(
                f"{path}: its header line {comment[:60]!a} may set an unknown unit or scale; give "
                "only '# Width:', '# Height:' and '# Value units:'"
            )
    return (sides.get("width"), sides.get("height")), metres_per_value, details, counts


def _statement(comment: str) -> tuple[str, str]:
    entry = _STATEMENT.fullmatch(comment)
    return (entry["key"].strip().lower(), entry["value"].strip()) if entry else ("", "")


def _counts(key: str, value: str) -> _Counts:
    if key in _COLUMNS | _LINES and value.isdecimal() and len(value) < 10:
        return {"values" if key in _COLUMNS else "lines": int(value)}
    if key in ("pixels", "resolution", "shape") and (both := _BOTH.fullmatch(value)):
        return {"values": int(both[1]), "lines": int(both[2])}
    return {}


def _check_counts(path: Path, stated: _Counts, read: tuple[int, int]) -> None:
    for what, there in zip(("values", "lines"), read, strict=True):
        if stated.get(what, there) != there:
            raise SurfaceError(
                f"{path}: its header states {stated[what]} {what}, but the file has {read[1]} "
                f"lines of {read[0]} values, so a part is missing; export it again"
            )


@dataclass(frozen=True)
class _Axes:
    x: float
    y: float

    @property
    def steps(self) -> str:
        return f"steps of {self.x:.6g} along x and {self.y:.6g} along y, in a unit not stated"

    def notice(self, path: Path) -> str:
        return (
            f"{path}: the first line and the first column are taken for the axes of x and y "
            f"({self.steps}) and left out of the heights"
        )


def _axes_of(values: Array) -> _Axes | None:
    """The axes of a matrix of lines; None if its first line and column are heights.

    In a plane, all lines and columns have even steps; so those beside the axes must not have them.
    """
    if min(values.shape) <= _LEAST_AXIS:
        return None
    x, y = _step(values[0, 1:]), _step(values[1:, 0])
    if x is None or y is None or (_step(values[1, 1:]) and _step(values[1:, 1])):
        return None
    return _Axes(abs(x), abs(y))


def _step(points: Array) -> float | None:
    """The step of evenly spaced points; None if they are uneven, equal or undefined."""
    if not np.isfinite(points).all():
        return None
    steps = np.diff(points)
    step = float(steps.mean())
    return step if step and np.abs(steps - step).max() <= _EVEN * abs(step) else None
