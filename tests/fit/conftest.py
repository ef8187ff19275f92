"""Small cases whose restitution is known."""

from pathlib import Path

import numpy as np
import pytest

from restitution import collide, loading_path
from restitution.case.case_file import parse_case
from restitution.fit.fit import fit
from restitution.fit.measured import Measured

SMOOTH = """
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.25
density = "7850 kg/m^3"
[interface]
yield_pressure = "{yields}"
{rough}
[grid]
nodes = 48
spacing = "0.8 um"
[impact]
velocity = ["0.01 m/s", "0.02 m/s", "0.04 m/s", "0.06 m/s", "0.09 m/s", "0.13 m/s"]
[unloading]
curves = 0
"""
ROUGH = """
[roughness]
kind = "gaussian"
rms = "{rms}"
correlation_length = "6 um"
seed = 1
realisations = 3
"""


@pytest.fixture(scope="session")
def smooth_case():
    """The text of a smooth case that yields at a pressure."""
    return lambda yields: SMOOTH.format(yields=yields, rough="")


@pytest.fixture(scope="session")
def rough_case():
    """The text of a rough case, of three surfaces."""
    return lambda yields, rms: SMOOTH.format(yields=yields, rough=ROUGH.format(rms=rms))


@pytest.fixture(scope="session")
def measure():
    """What an experiment on the case `text` finds: noise in shares of COR, from a seed."""

    def call(text, *, noise=0.0, seed=0, given=True):
        case = parse_case(text)
        V = np.array(case.depths())
        paths = [
            loading_path(case.variant(number).contact(Path()), velocities=V)
            for number in range(case.realisations)
        ]
        exact = np.mean([[collide(state).restitution for state in path] for path in paths], axis=0)
        std = noise * exact
        found = np.clip(exact + std * np.random.default_rng(seed).standard_normal(V.size), 0, 1)
        return Measured(V, found, std if given else None)

    return call


@pytest.fixture(scope="session")
def recovered(rough_case, measure):
    """The fit of a rough case whose yield pressure is 1 GPa and rms 0.05 um, with 2 % noise."""
    measured = measure(rough_case("1000 MPa", "0.05 um"), noise=0.02, seed=11)
    return fit(rough_case("1700 MPa", "0.03 um"), Path(), measured, ["yield_pressure", "rms"])
