"""The seed case: two steel spheres of 500 um radius, 512 x 512 nodes of 0.25 um."""

import pytest

from restitution import Body, Grid, Pair


@pytest.fixture(scope="session")
def pair():
    steel = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25, density=7850.0)
    return Pair(steel, steel)


@pytest.fixture(scope="session")
def grid():
    return Grid((512, 512), (0.25e-6, 0.25e-6))
