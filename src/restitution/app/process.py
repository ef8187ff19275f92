"""The server's side of a worker process, which starts with the first request after its end.

It is terminated if an abandoned request does not stop by itself.
"""

from __future__ import annotations

import asyncio
import itertools
import multiprocessing
import threading
from collections.abc import AsyncGenerator
from contextlib import suppress
from pathlib import Path
from typing import Any

from restitution.app.figures import as_json
from restitution.app.worker import Request, serve

_PATIENCE = 1.5  # time (s) that a cancelled request may take to stop
_LOST = as_json(
    {
        "error": "the process that computes has ended unexpectedly (perhaps because the memory was "
        "full); the next change starts it again",
        "lost": True,
    }
)
_CLOSED = as_json({"error": "the program has ended; start restitution app again", "lost": True})
# A process that does not stop an abandoned request is terminated. Its other requests then get this
# line as their answer, and `ask` repeats them.
_AGAIN = "again"
_Lines = asyncio.Queue[str | None]


class Process:
    """One worker process, which reads scans from `scans` and writes files into `room`."""

    def __init__(self, scans: Path, room: Path) -> None:
        self._folders = scans, room
        self._numbers = itertools.count(1)
        self._running: _Running | None = None

    async def ask(self, tab: str, kind: str, **values: Any) -> AsyncGenerator[str]:
        """Yield the lines of JSON that answer a request. Closing the generator cancels it."""
        line: str | None = _AGAIN
        while line is _AGAIN:
            if self._running is None or not self._running.usable:
                self._running = _Running(*self._folders)
            running, number, lines = self._running, next(self._numbers), _Lines()
            running.waiting[number] = lines
            try:
                running.send(Request(number, tab, kind, values))
                while (line := await lines.get()) not in (None, _AGAIN):
                    yield line
            except BaseException:
                running.give_up(number, lines)
                raise

    def stop(self) -> None:
        """End the process."""
        if self._running is not None:
            self._running.end(_CLOSED)


class _Running:
    def __init__(self, scans: Path, room: Path) -> None:
        context = multiprocessing.get_context("spawn")
        self._connection, theirs = context.Pipe()
        self.process = context.Process(target=serve, args=(theirs, scans, room), daemon=True)
        self.process.start()
        theirs.close()  # otherwise `_receive` would not notice that the process has ended
        self.waiting: dict[int, _Lines] = {}
        self._last_words = ""  # line that waiting requests get if the process is ended on purpose
        self._watching: set[asyncio.Task[None]] = set()
        self._loop = asyncio.get_running_loop()
        threading.Thread(target=self._receive, daemon=True).start()

    @property
    def usable(self) -> bool:
        """Whether the process is alive and `end` was not called."""
        return not self._last_words and self.process.is_alive()

    def send(self, message: Request | int) -> None:
        with suppress(OSError):  # the process has ended; `_receive` reports this
            self._connection.send(message)

    def give_up(self, number: int, lines: _Lines) -> None:
        """Tell the process to stop a request; end the process if the request goes on."""
        if not self.usable:
            return
        self.send(number)

        async def watch() -> None:
            with suppress(TimeoutError):
                async with asyncio.timeout(_PATIENCE):
                    while await lines.get() is not None:
                        pass
                return
            self.waiting.pop(number, None)
            self.end(_AGAIN)

        task = self._loop.create_task(watch())
        self._watching.add(task)
        task.add_done_callback(self._watching.discard)

    def end(self, last_words: str) -> None:
        """End the process. Requests that still wait get the line `last_words` as their answer."""
        self._last_words = last_words
        self.process.terminate()
        for task in self._watching - {asyncio.current_task()}:
            task.cancel()

    def _receive(self) -> None:
        with suppress(EOFError, OSError, RuntimeError):  # RuntimeError: the loop is closed
            while True:
                self._loop.call_soon_threadsafe(self._put, *self._connection.recv())
        with suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._lose)

    def _put(self, number: int, line: str | None) -> None:
        if number in self.waiting:
            self.waiting[number].put_nowait(line)
            if line is None:
                del self.waiting[number]

    def _lose(self) -> None:
        self._last_words = self._last_words or _LOST
        self.process.join(timeout=0)
        for lines in self.waiting.values():
            lines.put_nowait(self._last_words)
            lines.put_nowait(None)
        self.waiting.clear()
