"""The curve that the page redraws while a slider moves: of the first surface, without errors."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from restitution.app.figures import (
    ContactMaps,
    as_json,
    curve_figures,
    live_dataset,
    surface_content,
)
from restitution.app.headline import headline
from restitution.app.preview import Ladder, Level, Pace
from restitution.case.case import Case
from restitution.case.case_file import parse_case
from restitution.case.derived import deepest_indentation
from restitution.case.omissions import default_yield, omissions
from restitution.contact.contact import Contact
from restitution.curve.curve import UnloadingCurve
from restitution.curve.follow import follow
from restitution.curve.point import Point
from restitution.errors import DomainError, RestitutionError
from restitution.runs.depths import CaseUnloading, loads_of
from restitution.runs.error_budget import ErrorBudget
from restitution.runs.losses import loss_warnings, unloading_of, with_losses
from restitution.runs.messages import input_warnings, require_possible
from restitution.runs.refinement import least_refined, with_chosen_adhesion, with_chosen_grids
from restitution.runs.smooth import smooth_curve
from restitution.runs.two_scales import solve_patches
from restitution.surfaces import Surface

_PARTIAL = 0.7  # time (s) between two drawings of a curve that is still being computed
_FIRST = 0.25  # time (s) after which the first preview is drawn as far as it has come
_TABS = 4  # number of tabs whose last curves are kept


class LiveCurves:
    """The last curve of each open browser tab."""

    def __init__(self) -> None:
        self._curves: dict[str, _Curve] = {}
        self._surface: tuple[str, Surface] | None = None
        self._pace = Pace()

    def lines(self, tab: str, text: str, folder: Path, check: Callable[[], None]) -> Iterator[str]:
        """Compute the curve of the case `text`; yield lines of JSON for the page.

        If the curve takes long, previews come first. The scans of the case are in `folder`. `check`
        raises if the curve is no longer wanted.
        """
        asked = time.perf_counter()
        case = parse_case(text).realisation(0)
        case.require_impact()
        # With "auto", the grids are chosen after the previews, which takes solves.
        curve = self._curve(least_refined(case, folder), folder, asked)
        yield from curve.previews(self._pace, check)
        ladder, began = curve.ladder, time.perf_counter()
        if (chosen := with_chosen_grids(case, folder)) is not case:
            curve = self._curve(chosen, folder, began)
        self._curves.pop(tab, None)
        self._curves[tab] = curve
        if len(self._curves) > _TABS:
            del self._curves[next(iter(self._curves))]
        yield from curve.compute(folder, check)
        self._pace.note(ladder, len(ladder.levels) - 1, time.perf_counter() - began)

    def maps(self, tab: str, depth: int) -> Iterator[str]:
        """Yield the contact maps at depth number `depth` of the last curve of `tab`."""
        curve = self._curves.get(tab)
        if curve is not None and len(curve.maps):
            yield curve.maps.line(min(max(depth, 0), len(curve.maps) - 1))

    def smooth(
        self, tab: str, shown: str, folder: Path, check: Callable[[], None]
    ) -> Iterator[str]:
        """Yield the smooth curve, the surface and the first errors of the last curve of `tab`.

        The surface is left out if `shown`, the hash of the heights on the page, is its own.
        """
        curve = self._curves.get(tab)
        if curve is not None:
            yield from curve.with_smooth(check)
            yield from curve.with_surface(shown, check)
            yield from curve.with_errors(folder, check)

    def _curve(self, case: Case, folder: Path, began: float) -> _Curve:
        contact = self._contact(case, folder)
        deepest = deepest_indentation(case)
        require_possible(contact, deepest)
        warnings = omissions(case) + loss_warnings(case)
        warnings += input_warnings(contact, deepest, case.prescribed)
        case = with_chosen_adhesion(case, contact, warnings.append)
        return _Curve(case, contact, warnings, began)

    def _contact(self, case: Case, folder: Path) -> Contact:
        scans = [folder / part.file for part in case.roughness if part.kind == "measured"]
        for part in case.roughness:
            if part.kind == "joined":
                scans += [path for path, _ in part.files(folder)]
        # Most sliders do not change the surface. A new time or size shows that a scan was replaced.
        stamps = [(scan.stat().st_mtime_ns, scan.stat().st_size) for scan in scans]
        key = repr((case.roughness, case.grid, stamps))
        if self._surface is not None and self._surface[0] == key:
            return case.contact_on(self._surface[1])
        contact = case.contact(folder)
        self._surface = key, contact.surface
        return contact


class _Curve:
    def __init__(self, case: Case, contact: Contact, warnings: list[str], began: float) -> None:
        self.case, self.contact, self.warnings, self.began = case, contact, warnings, began
        self.ladder = Ladder(case, contact)
        self.points: list[Point] = []
        self.maps = ContactMaps(contact)
        self.failure: RestitutionError | None = None

    def previews(self, pace: Pace, check: Callable[[], None]) -> Iterator[str]:
        """Yield the curves of coarser levels, unless the last level is expected soon."""
        ladder, drawn = self.ladder, False
        number = pace.first(ladder, time.perf_counter() - self.began)
        while number < len(ladder.levels) - 1:
            level, points = ladder.levels[number], list[Point]()
            words, start = ladder.words(level), time.perf_counter()
            shown, count, pause = start, len(level.depths), _PARTIAL if drawn else _FIRST
            for point in self._points(level, check):
                points.append(point)
                if time.perf_counter() - shown > pause and len(points) < count:
                    shown, progress = time.perf_counter(), f"{len(points)} of {count} depths"
                    if drawn:
                        yield as_json({"progress": progress, "next": words})
                    else:
                        yield self.line(points, progress, preview=words)
                        pause = _PARTIAL
            pace.note(ladder, number, time.perf_counter() - start)
            number, wanted = pace.next(ladder, number, time.perf_counter() - self.began)
            if wanted and points:
                drawn = True
                yield self.line(points, "", preview=words)

    def _points(self, level: Level, check: Callable[[], None]) -> Iterator[Point]:
        """The points of a preview with their usual errors; depths that fail are left out."""

        def fail(_: RestitutionError) -> bool:
            check()
            return True

        try:
            for impact in follow(self.ladder.loads(level), self.ladder.unloading, fail):
                check()
                yield replace(impact.point, total_error=self.ladder.usual_error(impact))
        except RestitutionError:  # the curve of the case reports it, or does without it
            return

    def compute(self, folder: Path, check: Callable[[], None]) -> Iterator[str]:
        """Yield the curve of the case, first its shallow part if it takes long."""
        began = drawn = time.perf_counter()
        count, failed = len(self.case.depths()), 0
        back: dict[float, UnloadingCurve] = {}

        def fail(error: RestitutionError) -> bool:
            nonlocal failed
            check()
            self.failure, failed = self.failure or error, failed + 1
            return not isinstance(error, DomainError)

        solve_patches(self.contact, lambda _: check())
        loads = loads_of(self.case, folder, self.contact, unloaded=0)
        for impact in follow(loads, CaseUnloading.of_case(self.case), fail):
            check()
            self.points.append(impact.point)
            if (unloaded := unloading_of(impact)) is not None:
                back[impact.point.indentation] = unloaded
            self.maps.add(impact.state, impact.point.indentation)
            number = len(self.points) + failed
            if time.perf_counter() - drawn > _PARTIAL and number < count:
                yield self.line(self.points, f"{number} of {count} depths")
                drawn = time.perf_counter()
        if self.failure is not None and not self.points:
            raise self.failure
        self.points = with_losses(self.case.pair(), self.case.losses(), self.points, back)
        yield self.line(self.points, "", seconds=time.perf_counter() - began)

    def line(self, points: list[Point], progress: str, **more: Any) -> str:
        results = live_dataset(self.case, self.contact, points)
        return as_json(
            {
                "curve": [point.cells() for point in points],
                "figures": curve_figures(results),
                **headline(points),
                "progress": progress,
                "spent": time.perf_counter() - self.began,
                "information": default_yield(self.case.yielding().source),
                "warnings": self.warnings,
                "failure": "" if self.failure is None else str(self.failure),
                **more,
            }
        )

    def with_smooth(self, check: Callable[[], None]) -> Iterator[str]:
        try:
            smooth = smooth_curve(self.contact, self.points, check)
        except RestitutionError:  # the smooth curve is optional
            return
        if smooth:
            results = live_dataset(self.case, self.contact, self.points).assign(smooth)
            yield as_json({"figures": curve_figures(results)})

    def with_surface(self, shown: str, check: Callable[[], None]) -> Iterator[str]:
        surface = self.contact.surface
        key = hashlib.blake2b(surface.height.tobytes(), digest_size=16).hexdigest()
        if key != shown:
            check()
            yield as_json({"surface_key": key, **surface_content(surface)})

    def with_errors(self, folder: Path, check: Callable[[], None]) -> Iterator[str]:
        """The curve with all errors but the scatter of surfaces, which takes most of the time."""
        if not self.case.total_error or not self.case.roughness or self.failure is not None:
            return
        budget = ErrorBudget(self.case, folder, self.points, lambda _: check(), scattered=False)
        try:
            budget.add(self.contact.surface)
        except RestitutionError:  # the whole run reports it
            return
        yield self.line(budget.points, "", errors="of solver, grid and materials")
