"""A polite end when a terminal closes or a scheduler's time is up: as if Ctrl-C had been typed."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class Stopped(KeyboardInterrupt):
    """The signal that asks this process to end; `status` is what the shell expects of it."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.status = 128 + number


# Compiled code that calls back into Python may turn `Stopped` into an error of its own: what has
# been received tells such an error from one of the program.
received: list[int] = []


@contextmanager
def stoppable() -> Iterator[None]:
    """Raise `Stopped` on SIGTERM and SIGHUP, unless the process was started to ignore them."""

    def stop(number: int, _: FrameType | None) -> None:
        received.append(number)
        raise Stopped(number)

    before = {}
    # Windows has no SIGHUP.
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) == signal.SIG_DFL:
            before[number] = signal.signal(number, stop)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
