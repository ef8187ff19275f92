"""A collision that several tests of the tangential law share."""

import pytest

from elastic_force import ALUMINA, GLASS_WALL, elastic
from restitution import Pair


@pytest.fixture(scope="package")
def wall():
    """The stored force of an elastic alumina sphere on a glass wall, up to 3.9 m/s."""
    return elastic(Pair(ALUMINA, GLASS_WALL), 3.9)
