"""How much is tried: `FUZZ` in the environment multiplies it (`make fuzz`)."""

import contextlib
import os
import signal

import pytest

from restitution.errors import one_line


@pytest.fixture(scope="session")
def fuzz():
    """The factor by which more is tried than in the suite."""
    return float(os.environ.get("FUZZ", "1"))


@pytest.fixture
def plainly_refused():
    """Whether an error is one that the command line says in one line of fewer than 1000 signs."""

    def plain(error):
        said = one_line(str(error))
        return 0 < len(said) < 1000 and said.isprintable() and "Value error" not in said

    return plain


@pytest.fixture
def within():
    """A block that may take so many seconds."""

    @contextlib.contextmanager
    def limit(seconds):
        def stop(*_):
            raise TimeoutError(f"took more than {seconds} s")

        before = signal.signal(signal.SIGALRM, stop)
        signal.setitimer(signal.ITIMER_REAL, seconds)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)

    return limit


@pytest.fixture(scope="session")
def tiny_case(case_text):
    """The text of a case that takes a tenth of a second."""
    for old, new in (
        ("[72, 64]", "[32, 32]"),
        ('["0.5 um", "0.6 um"]', '"1 um"'),
        ("2 um", "4 um"),
        ("steps = 4", "steps = 3"),
    ):
        assert old in case_text
        case_text = case_text.replace(old, new)
    return case_text
