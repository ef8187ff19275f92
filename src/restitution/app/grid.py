"""The grid that the page chooses for a case without one."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path
from typing import Any

from restitution.app.content import Content, joins_scans, scans_of, text_of
from restitution.case.case import Case
from restitution.case.case_file import parse_case, parse_toml, problems_of
from restitution.case.generated import GeneratedRoughness
from restitution.case.measured import MeasuredRoughness
from restitution.contact.checks.edge import MARGIN
from restitution.contact.checks.resolution import NODES_PER_RADIUS, predicted_radius
from restitution.display import quantity
from restitution.numerics.grid import Grid

_PROBE = {"nodes": 64, "spacing": "1 nm"}  # a grid with which a case without one is read
_FEWEST, _MOST, _MOST_ADHESIVE = 64, 512, 256  # nodes along an edge
_LARGEST = 1024  # along an edge, if fewer would not carry the waves
_MULTIPLE = 32  # its multiples have small prime factors
# Cells in a correlation length: with fewer patches are unresolved, or the waves not carried.
_PER_WAVE, _FEWEST_PER_WAVE = 20.0, 6.0
_PEAK = 4.0  # height of the highest asperity, in units of Rq
_MOST_PIXELS, _OF_SCAN = 1.1e6, 512  # of a scan whose pixels become the nodes; nodes for others


def with_grid(text: str, folder: Path) -> tuple[str, Content | None]:
    """The case file `text` with a grid, and the table of this grid, or None if the case has one.

    The grid contains the contact at the highest velocity, and its cells resolve the waves or the
    smallest contact, as far as `_MOST` nodes along an edge allow. With adhesion, `grid.refine` is
    "auto". The pixels of a scan are the grid unless there are more than `_MOST_PIXELS`.
    """
    content = parse_toml(text)
    own = content.get("grid", {})
    if not isinstance(own, dict) or {"nodes", "spacing"} & set(own):
        return text, None
    if scans_of(content) and not joins_scans(content):
        chosen = _of_scans(text, folder)
    else:
        # Many impacts need a larger grid than the probe.
        first = {name: table for name, table in content.items() if name != "impacts"}
        probe = {**first, "grid": {**own, **_PROBE}}
        if problems_of(probe):
            return text_of(probe), None
        chosen = _of_case(parse_case(text_of(probe)), own, folder)
    grid = {**chosen, **own}
    return text_of({**content, "grid": grid} if grid else content), grid


def _of_case(case: Case, own: Content, folder: Path) -> Content:
    pair, limit = case.pair(), case.yielding().hardness
    depths = [case.indentation_at(depth) for depth in case.depths()]
    parts = [part for part in case.roughness if isinstance(part, GeneratedRoughness)]
    heights = [part.rms_height(folder) for part in case.roughness]
    height = _PEAK * math.hypot(*heights) if heights else 0.0
    reach = math.sqrt(2 * pair.radius * (depths[-1] + height)) if heights else 0.0
    edge = 2 * MARGIN * max(reach, predicted_radius(pair, depths[-1], limit))
    waves = [length for part in parts for length in _lengths(part)]
    edge = max(edge, *(2.5 * length for length in waves), 0.0)
    wanted = predicted_radius(pair, depths[0], limit) / NODES_PER_RADIUS
    most: float = _MOST_ADHESIVE if case.interface.adhesive_energy else _MOST
    if waves:
        wanted = min(waves) / _PER_WAVE
        most = max(most, min(_LARGEST, edge * _FEWEST_PER_WAVE / min(waves)))
    count = min(max(edge / wanted, _FEWEST), most)
    nodes = _MULTIPLE * math.ceil(count / _MULTIPLE)
    grid: dict[str, Any] = {"nodes": nodes, "spacing": _rounded_up(edge / nodes)}
    if case.interface.adhesive_energy and "refine" not in own:
        grid["refine"] = "auto"
    return grid


def _lengths(part: GeneratedRoughness) -> list[float]:
    if part.correlation_length is not None:
        return list(part.correlation_length)
    return [] if part.rolloff is None else [part.rolloff]


def _rounded_up(length: float) -> str:
    step = 10.0 ** (math.floor(math.log10(length)) - 2)
    return quantity(math.ceil(length / step) * step, "m").replace("µ", "u")


def _of_scans(text: str, folder: Path) -> Content:
    if problems_of(parse_toml(text)):
        return {}
    part, *others = parse_case(text).roughness
    if others or not isinstance(part, MeasuredRoughness) or not (folder / part.file).is_file():
        return {}
    stamp = (folder / part.file).stat()
    pixels = _pixels(part, folder, (stamp.st_mtime_ns, stamp.st_size))
    if math.prod(pixels.nodes) <= _MOST_PIXELS:
        return {}
    return {"nodes": _OF_SCAN, "spacing": _rounded_up(max(pixels.spacing))}


@lru_cache(maxsize=4)
def _pixels(part: MeasuredRoughness, folder: Path, _: tuple[int, int]) -> Grid:
    return part.scan(folder).grid
