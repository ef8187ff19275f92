"""Laws built by hand, and the DEM programs that run what was exported."""

import re
import shutil
import subprocess

import numpy as np
import pytest

from restitution.dem.fitted import fitted_laws
from restitution.dem.law import Law, Particle, Point
from restitution.dem.matrix import Matrix, matrix_of

GLASS = Particle(
    name="glass", radius=1e-3, youngs_modulus=70e9, poissons_ratio=0.25, density=2500.0
)
STEEL = Particle(
    name="steel", radius=0.4e-3, youngs_modulus=200e9, poissons_ratio=0.3, density=7800.0
)
PLATE = Particle(name="plate", radius=None, youngs_modulus=3e9, poissons_ratio=0.4, density=None)


def law_of(first=GLASS, second=GLASS, at=1.0, **changes):
    """A law whose e falls from 0.95 at 0.01 m/s to 0.3 at 10 m/s, `at` times sooner."""
    bodies = first, second
    E = 1 / sum((1 - body.poissons_ratio**2) / body.youngs_modulus for body in bodies)
    R = 1 / sum(0 if body.wall else 1 / body.radius for body in bodies)
    m = 1 / sum(
        0 if body.wall else 1 / (body.density * 4 / 3 * np.pi * body.radius**3) for body in bodies
    )
    V = np.geomspace(0.01, 10, 13)
    e = np.maximum(0.95 - 0.65 * (np.log10(V * at) + 2) / 3, 0.1)
    points = tuple(
        Point(
            velocity=v,
            restitution=float(c),
            error=0.004,
            ratio=float(c**2),
            loading_work=0.5 * m * v**2,
            indentation=1e-6,
            force=1.0,
            pull_off_force=None,
            resolved=True,
        )
        for v, c in zip(V.tolist(), e, strict=True)
    )
    values = {
        "title": "by hand",
        "first": first,
        "second": second,
        "radius": R,
        "contact_modulus": E,
        "mass": m,
        "yield_pressure": 1e9,
        "work_of_adhesion": 0.0,
        "model": {},
        "conventions": {
            "yield_pressure": "mean pressure of a plastic contact",
            "end_of_contact": "the force is back to zero",
            "indentation_zero": "first touch",
            "restitution": "by hand",
            "restitution_error": "numerical error",
        },
        "yield_velocity": 0.001,
        "sticking_velocity": None,
        "sticks_below": None,
        "points": points,
    }
    return Law(**values | changes)


@pytest.fixture(scope="session")
def law():
    """The maker of laws, `law_of`."""
    return law_of


@pytest.fixture(scope="session")
def points(law):
    """The law of two glass spheres, with what is fitted to it."""
    found = law(yield_pressure=560e6)
    return found.model_copy(update={"laws": fitted_laws(found)})


@pytest.fixture(scope="session")
def constant():
    """Make a law of the same e at every velocity from another."""

    def make(law, e):
        changes = {"restitution": e, "ratio": e**2}
        points = tuple(point.model_copy(update=changes) for point in law.points)
        return law.model_copy(update={"points": points})

    return make


@pytest.fixture(scope="session")
def equal() -> Matrix:
    """Two equal spheres."""
    return matrix_of([law_of()])


@pytest.fixture(scope="session")
def mixed() -> Matrix:
    """Two unlike spheres, all pairs of them, and both on a wall."""
    return matrix_of(
        [
            law_of(),
            law_of(STEEL, GLASS, at=1.5),
            law_of(STEEL, STEEL, at=0.8),
            law_of(GLASS, PLATE, at=2.0),
            law_of(PLATE, STEEL, at=3.0),
        ]
    )


@pytest.fixture(scope="session")
def on_wall() -> Matrix:
    """A sphere on a wall, and nothing else."""
    return matrix_of([law_of(GLASS, PLATE)])


@pytest.fixture
def hostile() -> Particle:
    """A sphere whose name tries to leave every comment and script."""
    name = '"""\n*/ } shell rm\r\n${x} $(y) \\'
    return GLASS.model_copy(update={"name": name + "\nquit 1\u2028 ' ; # Größe µ €&"})


@pytest.fixture
def texts(tmp_path):
    """Write files by name into a folder of its own."""

    def write(files, folder="run"):
        place = tmp_path / folder
        place.mkdir()
        for name, text in files.items():
            (place / name).write_text(text, encoding="utf-8")
        return place

    return write


class Program:
    """A DEM program that runs collisions as they were written; skips the test where missing."""

    def __init__(self, name, script, environment):
        path = shutil.which(name, path=environment["PATH"])
        self.command = [path or pytest.skip(f"{name} is not installed"), *script]
        self.environment = environment

    def says(self, folder, *arguments, status=0):
        """What it prints, run in `folder`."""
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
        """The rebound ratios of the collisions it ran."""
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
    """LIGGGHTS as Debian has it."""
    return Program("liggghts", ["-in", "collision.in.liggghts", "-log", "none"], CLEAN)


@pytest.fixture(scope="session")
def yade(tmp_path_factory) -> Program:
    """YADE as Debian has it; it wants a home folder to write to."""
    home = {"HOME": str(tmp_path_factory.mktemp("home"))}
    return Program("yade", ["-n", "-x", "-j1"], CLEAN | home)
