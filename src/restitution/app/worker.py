"""The process that computes for the page: it answers one `Request` after the other.

An answer is a series of lines of JSON, then None. A new request replaces an older one of the same
kind and browser tab, and a new curve every request of its tab, at once: it interrupts the solve.
"""

from __future__ import annotations

import json
import os
import re
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from tempfile import mkdtemp
from types import FrameType
from typing import Any

from restitution.app.content import problems_in
from restitution.app.curve import LiveCurves
from restitution.app.figures import as_json
from restitution.app.grid import with_grid
from restitution.app.runs import Progress, Runs, results_line
from restitution.case.case_file import parse_case
from restitution.errors import CaseError, RestitutionError, one_line

REPLACED = as_json({"replaced": True})
_REPEAT_AFTER = 0.05  # time (s) after which an interrupt that came during an import comes again


@dataclass(frozen=True)
class Request:
    """A request of one browser tab; the method `kind` of `Worker` answers it with `values`."""

    number: int
    tab: str
    kind: str
    values: dict[str, Any]


class NotWanted(KeyboardInterrupt):
    """A newer request has replaced this request, or the page was closed."""


class Inbox:
    """The waiting requests. A new request replaces an older one of the same tab and kind."""

    def __init__(self, connection: Connection) -> None:
        self._connection, self._sending = connection, threading.Lock()
        self._waiting: dict[tuple[str, str], Request] = {}
        self._now: Request | None = None
        self._given_up: set[int] = set()
        self._changed = threading.Condition()
        self._can_stop = False  # whether `_interrupt` raises; only the main thread changes it
        # Ctrl-C reaches every process of the terminal. It is ignored, because the parent ends this
        # process; the thread sends the same signal to interrupt a solve.
        signal.signal(signal.SIGINT, self._interrupt)
        threading.Thread(target=self._listen, daemon=True).start()

    def send(self, number: int, line: str | None) -> None:
        """Send a line of the answer to request `number`, or None at its end."""
        can_stop, self._can_stop = self._can_stop, False
        self._put(number, line)
        self._can_stop = can_stop
        if can_stop:
            self.check()

    def next(self) -> Request:
        """Wait for a request, and return the one that has waited longest."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting)
            key = next(iter(self._waiting))
            self._now = self._waiting.pop(key)
            self._given_up.clear()  # numbers of earlier requests, which are all answered
            return self._now

    @property
    def wanted(self) -> bool:
        """Whether the request that `next` returned last is still wanted."""
        with self._changed:
            now = self._now
            if now is None:
                return False
            newer = {(now.tab, now.kind), (now.tab, "curve")}
            return now.number not in self._given_up and not newer & self._waiting.keys()

    def check(self) -> None:
        """Raise `NotWanted` if the request that `next` returned last is no longer wanted."""
        if not self.wanted:
            raise NotWanted

    @contextmanager
    def stoppable(self) -> Iterator[None]:
        """Raise `NotWanted` in the `with` body as soon as its request is no longer wanted."""
        self._can_stop = True
        try:
            self.check()
            yield
        finally:
            self._can_stop = False

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        if not self._can_stop or self.wanted:
            return
        if _imports(frame):  # an import that is interrupted can leave a module that is unusable
            again = threading.Timer(_REPEAT_AFTER, signal.raise_signal, (number,))
            again.daemon = True
            again.start()
            return
        self._can_stop = False
        raise NotWanted

    def _put(self, number: int, line: str | None) -> None:
        with self._sending:
            self._connection.send((number, line))

    def _listen(self) -> None:
        """Receive new requests and numbers of requests given up, until the parent process ends."""
        while True:
            try:
                message = self._connection.recv()
            except (EOFError, OSError):
                os._exit(0)  # end even during a solve, because nobody needs its result
            with self._changed:
                if isinstance(message, Request):
                    self._drop((message.tab, message.kind))
                    self._waiting[message.tab, message.kind] = message
                else:
                    # If the request is in progress, `check` stops it. If it still waits, drop it.
                    self._given_up.add(message)
                    for key in [k for k, other in self._waiting.items() if other.number == message]:
                        self._drop(key)
                self._changed.notify_all()
            if not self.wanted:
                signal.raise_signal(signal.SIGINT)

    def _drop(self, key: tuple[str, str]) -> None:
        dropped = self._waiting.pop(key, None)
        if dropped is not None:
            self._put(dropped.number, REPLACED)
            self._put(dropped.number, None)


def _imports(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


class Worker:
    """Answers requests, with a method for each kind; see `Process` for the folders."""

    def __init__(self, scans: Path, room: Path, check: Callable[[], None]) -> None:
        self._scans, self._room, self._check = scans, room, check
        self._curves, self._runs = LiveCurves(), Runs(room)
        self._send: Callable[[str], None] = lambda _: None

    def answer(self, request: Request, send: Callable[[str], None]) -> None:
        """Send the answer to `request`, line by line."""
        self._send = send
        values = dict(request.values)
        if "text" in values:
            with suppress(CaseError):  # `problems_in` reports it
                values["text"], grid = with_grid(values["text"], self._scans)
                if grid is not None and request.kind == "curve":
                    send(as_json({"grid": grid}))
            if problems := problems_in(values["text"], self._scans):
                send(as_json({"problems": problems}))
                return
        for line in getattr(self, request.kind)(request.tab, **values):
            send(line)

    def curve(self, tab: str, text: str) -> Iterator[str]:
        """Compute the curve of the case `text`; yield it as lines of JSON while it grows."""
        return self._curves.lines(tab, text, self._scans, self._check)

    def smooth(self, tab: str, shown: str) -> Iterator[str]:
        """Yield the smooth curve and the surface that belong to the last live curve."""
        return self._curves.smooth(tab, shown, self._scans, self._check)

    def maps(self, tab: str, depth: int) -> Iterator[str]:
        """Yield the contact maps at one depth of the last live curve."""
        return self._curves.maps(tab, depth)

    def run(self, tab: str, text: str, grids: int) -> Iterator[str]:
        """Yield the results of the complete run or, if `grids` > 1, of a convergence study."""
        yield results_line(self._folder(text, grids))

    def take(
        self, tab: str, text: str, what: str, code: str, velocity: str, grids: int
    ) -> Iterator[str]:
        """Write the download `what`, and yield its path relative to the folder `room`."""
        from restitution.app import take_away

        out = Path(mkdtemp(dir=self._room, prefix="take-"))
        if what == "case":
            file = take_away.case_file(text, self._scans, out)
        else:
            file = take_away.take(what, self._folder(text, grids), out, code, velocity)
        yield as_json({"file": str(file.relative_to(self._room))})

    def show(self, tab: str, text: str, code: str, velocity: str, grids: int) -> Iterator[str]:
        """Yield the lines of an export without their comments, and the name of their file."""
        from restitution.app import take_away

        file, lines = take_away.lines_of(self._folder(text, grids), code, velocity)
        yield as_json({"file": file, "text": lines})

    def read(self, tab: str, file: str) -> Iterator[str]:
        """Read a scan; yield its nodes and spacing, or what the form must add, and why."""
        from restitution.surfaces import read_surface
        from restitution.surfaces.joined.read import HowToRead, read_spectra
        from restitution.surfaces.reading.containers import is_container
        from restitution.surfaces.refused import RefusedSurfaceError

        if is_container(self._scans / file):
            scans = list(read_spectra(self._scans / file, HowToRead(undefined="interpolate")))
            yield as_json({"scans": len(scans), "nodes": scans[0].surface.grid.nodes})
            return
        try:
            surface = read_surface(self._scans / file, undefined="interpolate")
        except RefusedSurfaceError as error:
            if (needed := _NEEDED.get(error.code)) is None:
                raise
            yield as_json({needed: error.fact})
            return
        yield as_json({"nodes": surface.grid.nodes, "spacing_m": surface.grid.spacing})

    def _folder(self, text: str, grids: int) -> Path:
        progress = Progress(parse_case(text), grids)

        def report(words: str) -> None:
            self._check()
            self._send(as_json({"progress": words, "share": progress.after(words)}))

        return self._runs.folder(text, self._scans, report, grids)


# What the form can add to a scan that is refused, by the code of the error.
_NEEDED = {
    "size-unknown": "needs_size",
    "size-impossible": "needs_size",
    "height-unit-unknown": "needs_height_unit",
    "heights-impossible": "needs_height_unit",
}


def _send_without_folders(inbox: Inbox, number: int, room: Path, line: str | None) -> None:
    """Send `line`; in messages, files in the temporary folder `room` have only their names."""
    if line is not None:
        folder = re.escape(json.dumps(str(room))[1:-1])
        line = re.sub(f'{folder}/results-[^/:" ]+', "the results", line)
        line = re.sub(f"{folder}/scans/", "", line)
    inbox.send(number, line)


def serve(connection: Connection, scans: Path, room: Path) -> None:
    """Answer requests until the parent process closes the connection or ends."""
    os.environ["MPLBACKEND"] = "agg"
    inbox = Inbox(connection)
    worker = Worker(scans, room, inbox.check)
    while True:
        request = inbox.next()
        send = partial(_send_without_folders, inbox, request.number, room)
        try:
            with inbox.stoppable():
                worker.answer(request, send)
        except NotWanted:
            send(REPLACED)
        except RestitutionError as error:
            send(as_json({"error": str(error)}))
        except MemoryError:
            send(as_json({"error": "the memory is too small for this case; use fewer grid.nodes"}))
        except Exception as error:
            words = one_line(f"{type(error).__name__}: {error}")
            unexpected = as_json({"error": f"stopped by an unexpected error, {words}"})
            # Compiled code can turn an interrupt into another error.
            send(unexpected if inbox.wanted else REPLACED)
        with suppress(BrokenPipeError):
            send(None)
