"""Delay Ctrl-C and similar signals during operations that must complete.

Python can raise `KeyboardInterrupt` between any two instructions. If this happens inside a library
that reads or writes netCDF files, the library keeps its locks, and the next access waits forever.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

_NAMES = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows has no SIGHUP
_Handler = Callable[[int, FrameType | None], object]

_depth = 0  # number of nested `hold_signals` blocks that are active
_received: list[int] = []
_handlers: dict[int, _Handler] = {}


@contextmanager
def hold_signals() -> Iterator[None]:
    """Delay SIGINT, SIGTERM and SIGHUP until the `with` body has ended, normally or by an error.

    Only signals with a Python handler are delayed: others raise no exceptions. Only the main thread
    receives signals, so in other threads this does nothing.
    """
    global _depth
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    if not _depth:
        _received.clear()
        _install()
    # Python cannot handle a signal between `_depth += 1` and `try`, or between `_depth -= 1` and
    # `if`. Therefore a signal cannot leave a wrong value in `_depth`.
    _depth += 1
    try:
        yield
    finally:
        _depth -= 1
        if not _depth:
            _release()


def _install() -> None:
    for number in (getattr(signal, name) for name in _NAMES if hasattr(signal, name)):
        handler = signal.getsignal(number)
        if callable(handler) and handler is not _note:
            _handlers[number] = handler
            signal.signal(number, _note)


def _release() -> None:
    for number, handler in _handlers.items():
        if signal.getsignal(number) is _note:
            signal.signal(number, handler)
    if _received:
        first = _received[0]
        _received.clear()
        _handlers[first](first, None)


def _note(number: int, frame: FrameType | None) -> None:
    if _depth:
        _received.append(number)
    else:
        _handlers[number](number, frame)
