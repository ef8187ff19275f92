"""End on Ctrl-C, SIGTERM (time limit of a scheduler) and SIGHUP (closed terminal) alike."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

# A signal raises an exception, which Python may drop if the signal arrives during a callback. The
# signal is then sent again after this time (s), when the callback has returned.
_REPEAT_AFTER = 0.05


class Stopped(KeyboardInterrupt):
    """A signal told this process to end; `status` is the exit status that shells expect."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.status = 128 + number


# Signals received so far. Compiled code that calls Python may convert `Stopped` to another
# exception. If this list is not empty, such an exception comes from a signal and is not an error.
received: list[int] = []


@contextmanager
def stoppable() -> Iterator[None]:
    """Raise `Stopped` on SIGINT, SIGTERM and SIGHUP, unless already ignored (`nohup`) or handled.

    Python drops an exception that is raised in a destructor or in the callback of a weak reference.
    If it drops `Stopped`, the signal is sent again a moment later.
    """

    def stop(number: int, _: FrameType | None) -> None:
        received.append(number)
        raise Stopped(number)

    received.clear()
    drop = sys.unraisablehook

    def drop_or_repeat(dropped: sys.UnraisableHookArgs) -> None:
        error = dropped.exc_value
        if not isinstance(error, Stopped):
            drop(dropped)
            return
        timer = threading.Timer(_REPEAT_AFTER, _signal_main_thread, error.args)
        timer.daemon = True
        timer.start()

    sys.unraisablehook = drop_or_repeat
    # Windows has no SIGHUP.
    names = ("SIGINT", "SIGTERM", "SIGHUP")
    numbers = [getattr(signal, name) for name in names if hasattr(signal, name)]
    unhandled = (signal.SIG_DFL, signal.default_int_handler)
    defaults = [number for number in numbers if signal.getsignal(number) in unhandled]
    before = {number: signal.signal(number, stop) for number in defaults}
    try:
        yield
    finally:
        sys.unraisablehook = drop
        for number, handler in before.items():
            signal.signal(number, handler)


def _signal_main_thread(number: int) -> None:
    if hasattr(signal, "pthread_kill"):  # also interrupts a blocking system call of the main thread
        signal.pthread_kill(threading.main_thread().ident or 0, number)
    else:
        _thread.interrupt_main(signal.Signals(number))
