"""What tests of files share."""

import pytest

from restitution.errors import SurfaceError
from restitution.surfaces import read_surface


@pytest.fixture(scope="session")
def write():
    """Write a text to a path, which is returned."""

    def call(path, text, encoding="utf-8"):
        path.write_bytes(text.encode(encoding))
        return path

    return call


@pytest.fixture(scope="session")
def refusal():
    """The message that refuses a path: one line that names it and goes on to a remedy."""

    def call(path, **kwargs):
        with pytest.raises(SurfaceError) as caught:
            read_surface(path, **kwargs)
        message = str(caught.value)
        assert message.startswith(f"{path}: ")
        assert "; " in message
        assert "\n" not in message
        return message.removeprefix(f"{path}: ")

    return call
