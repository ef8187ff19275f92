"""A polite end when a terminal closes or a scheduler's time is up: as if Ctrl-C had been typed."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_AGAIN = 0.05  # s: by then the callback that swallowed a signal has returned


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
    """Raise `Stopped` on SIGTERM and SIGHUP, unless the process was started to ignore them.

    Python drops an exception that is raised in a destructor or in the callback of a weak reference.
    Where that is a signal, or Ctrl-C, it is raised again a moment later.
    """

    def stop(number: int, _: FrameType | None) -> None:
        received.append(number)
        raise Stopped(number)

    drop = sys.unraisablehook

    def drop_or_repeat(dropped: sys.UnraisableHookArgs) -> None:
        error = dropped.exc_value
        if not isinstance(error, KeyboardInterrupt):
            drop(dropped)
            return
        number = error.args[0] if isinstance(error, Stopped) else signal.SIGINT
        timer = threading.Timer(_AGAIN, _signal_main_thread, (number,))
        timer.daemon = True
        timer.start()

    sys.unraisablehook = drop_or_repeat
    before = {}
    # Windows has no SIGHUP.
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) == signal.SIG_DFL:
            before[number] = signal.signal(number, stop)
    try:
        yield
    finally:
        sys.unraisablehook = drop
        for number, handler in before.items():
            signal.signal(number, handler)


def _signal_main_thread(number: int) -> None:
    if hasattr(signal, "pthread_kill"):  # it also ends a sleep, or a call that waits
        signal.pthread_kill(threading.main_thread().ident or 0, number)
    else:
        _thread.interrupt_main(signal.Signals(number))
