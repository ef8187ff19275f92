"""Two laws for the scripts of this folder: a dry rough pair, and a sticking one."""

from __future__ import annotations

import tempfile
from pathlib import Path

from restitution.case.case_file import parse_case
from restitution.laws.from_results import bare_law
from restitution.laws.law import Law
from restitution.results.writer import ResultsFolder
from restitution.runs.run import run_case

ROUGH = """
title = "Rough glass"
total_error = false
[first]
material = "glass"
radius = "300 um"
[interface]
yield_pressure = "300 MPa"
[roughness]
kind = "gaussian"
rms = "40 nm"
correlation_length = "8 um"
seed = 1
[grid]
nodes = 64
spacing = "0.8 um"
[impact]
from = "0.02 m/s"
to = "2 m/s"
steps = 9
[unloading]
curves = 9
"""
STICKY = """
title = "A smooth elastic sphere with adhesion"
total_error = false
[first]
radius = "5 um"
youngs_modulus = "3 GPa"
poissons_ratio = 0.33
density = "1050 kg/m^3"
[interface]
work_of_adhesion = "0.05 J/m^2"
adhesion = "jkr"
yield_pressure = "100 GPa"
[grid]
nodes = 64
spacing = "15 nm"
[impact]
from = "0.05 m/s"
to = "1 m/s"
steps = 8
[unloading]
curves = 8
"""


def law_of_case(text: str) -> Law:
    """The law of the case `text`, run here."""
    with tempfile.TemporaryDirectory() as place:
        run_case(parse_case(text), text, Path(place), ResultsFolder(Path(place) / "run"))
        return bare_law(Path(place) / "run")
