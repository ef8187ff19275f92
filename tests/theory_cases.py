"""Cases of smooth bodies, and the theories beside them, for tests of `compare.theories`."""

import numpy as np

from restitution.case.case_file import parse_case
from restitution.compare import theories

SPHERE = 'radius = "1 mm"\nyoungs_modulus = "70 GPa"\npoissons_ratio = 0.25\n'
WALL = 'radius = "flat"\nyoungs_modulus = "200 GPa"\npoissons_ratio = 0.3\n'
LIGHT = 'density = "2500 kg/m^3"\n'
PLASTIC = 'yield_pressure = "560 MPa"\n'
IMPACT = '[impact]\nfrom = "1 mm/s"\nto = "100 m/s"\nsteps = 3\n'
V = np.geomspace(1e-4, 3000, 200)
YIELDING = {"thornton-ning", "johnson", "mdr"}


ELASTIC = 'yield_pressure = "elastic"\n'


def case_of(first=SPHERE + LIGHT, second=None, interface=PLASTIC, depths=IMPACT):
    tables = f"[first]\n{first}" + ("" if second is None else f"[second]\n{second}")
    grid = '[grid]\nnodes = 64\nspacing = "1 um"\n'
    return parse_case(f"{tables}[interface]\n{interface}{grid}{depths}")


def by_name(case, velocities=V, law=None):
    return {each.name: each for each in theories.theories(case, velocities, law)}
