"""Fixtures of the tests of files."""

import pytest

from restitution.errors import SurfaceError
from restitution.surfaces import read_surface


@pytest.fixture(scope="session")
def write():
    """Write a text to a path and return the path."""

    def call(path, text, encoding="utf-8"):
        path.write_bytes(text.encode(encoding))
        return path

    return call


@pytest.fixture(scope="session")
def refusal():
    """The error message for a path: one line with the path and a remedy."""

    def call(path, **kwargs):
        with pytest.raises(SurfaceError) as caught:
            read_surface(path, **kwargs)
        message = str(caught.value)
        assert message.startswith(f"{path}: ")
        assert "; " in message
        assert "\n" not in message
        return message.removeprefix(f"{path}: ")

    return call
