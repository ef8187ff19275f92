"""Signals are delayed until an operation that must complete has completed."""

import os
import signal
import sys
import threading

import pytest

from restitution.results.interruption import hold_signals


class SentError(Exception):
    """Raised by a handler of this test."""


@pytest.fixture
def handled():
    """Install a handler that raises `SentError` with the number of the signal."""

    def handle(number, _):
        raise SentError(number)

    names = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = {number: signal.signal(number, handle) for number in names}
    yield handle
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_is_raised_after_the_body(handled, number):
    done = []

    @hold_signals()
    def body():
        signal.raise_signal(number)
        done.append("body")

    with pytest.raises(SentError) as raised:
        body()
    assert done == ["body"]
    assert raised.value.args == (number,)
    assert signal.getsignal(number) is handled


def test_several_signals_are_one_after_the_outermost_body(handled):
    done = []

    @hold_signals()
    def body():
        with hold_signals():
            signal.raise_signal(signal.SIGTERM)
            signal.raise_signal(signal.SIGINT)
        done.append("between")

    with pytest.raises(SentError) as raised:
        body()
    assert done == ["between"]
    assert raised.value.args == (signal.SIGTERM,)
    with hold_signals():
        pass  # nothing is left over


def test_a_signal_is_raised_after_a_body_that_fails(handled):

    @hold_signals()
    def body():
        signal.raise_signal(signal.SIGINT)
        raise ValueError("full")

    with pytest.raises(SentError) as raised:
        body()
    assert isinstance(raised.value.__context__, ValueError)


def test_a_signal_after_the_body_is_raised_at_once(handled):
    with hold_signals():
        pass
    with pytest.raises(SentError):
        signal.raise_signal(signal.SIGINT)


def test_signals_that_do_not_raise_are_left_alone(handled):
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with hold_signals():
        assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
        assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
        signal.raise_signal(signal.SIGHUP)


def test_other_threads_hold_nothing(handled):
    found = []

    def hold():
        with hold_signals():
            found.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=hold)
    thread.start()
    thread.join()
    assert found == [handled]


def test_no_moment_loses_a_signal_or_a_body(handled):
    """A process that receives signals continuously never ends a body early."""
    begun = ended = raised = 0
    armed, stop = [], []

    def handle(number, _):
        if armed:  # once, between the two lines of a `try` below
            armed.clear()
            raise SentError(number)

    def send():
        while not stop:
            os.kill(os.getpid(), signal.SIGINT)

    signal.signal(signal.SIGINT, handle)
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    thread = threading.Thread(target=send)
    thread.start()
    while raised < 100:
        try:
            armed.append(True)
            with hold_signals():
                begun += 1
                sum(range(2000))
                ended += 1
            armed.clear()
        except SentError:
            raised += 1
    stop.append(True)
    thread.join()
    sys.setswitchinterval(before)
    assert begun == ended > 10
