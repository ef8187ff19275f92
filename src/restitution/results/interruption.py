"""Hold back Ctrl-C and its like while something is done that must not be left half done.

Python raises `KeyboardInterrupt` between any two instructions. Inside the libraries that write and
read netCDF files it would leave their locks taken, and the next access would wait for ever.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

_SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows has no SIGHUP
_Handler = Callable[[int, FrameType | None], object]

_depth = 0  # of nested `hold_signals`
_received: list[int] = []
_handlers: dict[int, _Handler] = {}


@contextmanager
def hold_signals() -> Iterator[None]:
    """Handle SIGINT, SIGTERM and SIGHUP after the body, however it ends.

    Only signals with a handler in Python are held: the others do not raise. Threads other than the
    main one receive no signals, so that nothing is done there.
    """
    global _depth
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    if not _depth:
        _received.clear()
        _install()
    # No signal is handled between this assignment and `try`, nor between the last one and `if`.
    _depth += 1
    try:
        yield
    finally:
        _depth -= 1
        if not _depth:
            _release()


def _install() -> None:
    for name in _SIGNALS:
        number = getattr(signal, name, None)
        handler = None if number is None else signal.getsignal(number)
        if number is not None and callable(handler) and handler is not _note:
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
    """Remember a signal while signals are held; pass it on where they are not (any more)."""
    if _depth:
        _received.append(number)
    else:
        _handlers[number](number, frame)
