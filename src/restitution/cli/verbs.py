"""The verbs with their arguments and options, in the groups of the help."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from restitution.cli.parameters import (
    CaseFile,
    DeviceName,
    ExportFormat,
    FigureFormat,
    Figures,
    OnDevice,
    OutFolder,
    Resume,
    Scheduler,
    UnitSystem,
    WorkerCount,
    flag,
    given,
    one_of,
    option,
    output,
    program,
    verb,
)

__all__ = ["program"]


def _material_names(incomplete: str) -> list[str]:
    from restitution.case.materials import materials

    return [key for key in materials() if key.startswith(incomplete)]


@verb("Prepare", "new")
def new(
    dem: Annotated[
        bool,
        flag("--dem", "Write a case for a DEM code, with COR against impact velocity."),
    ] = False,
    scan: Annotated[bool, flag("--scan", "Write a case with a measured surface.")] = False,
    study: Annotated[
        bool, flag("--study", "Write a study, which is a case with a table \\[sweep].")
    ] = False,
    powder: Annotated[
        bool,
        flag(
            "--powder",
            "Write a case for a fine adhesive powder, on a grid that resolves its adhesion.",
        ),
    ] = False,
    values: Annotated[
        list[str] | None,
        option(
            "KEY=VALUE",
            "With --powder: material, radius, rms, correlation_length or work_of_adhesion, "
            'for example radius="2 um"; may be repeated.',
            "--set",
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        output(
            "FILE",
            "File to write; an existing file is never overwritten.",
            show_default="case.toml, or study.toml",
        ),
    ] = None,
) -> None:
    """Write a commented case file or study file to start from."""


@verb("Prepare", "materials")
def materials(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME",
            help="Material to show, with the spread and the sources of its values.",
            show_default=False,
            autocompletion=_material_names,
        ),
    ] = None,
    adhesion: Annotated[
        bool,
        flag(
            "--adhesion",
            "List the work of adhesion of pairs (of NAME with the others, if given), which a "
            'case uses with work_of_adhesion = "library".',
        ),
    ] = False,
    json: Annotated[bool, flag("--json", "Print JSON, with values in SI units.")] = False,
) -> None:
    """List the materials that a case can name, or show the material NAME with its sources."""


@verb("Prepare", "check")
def check(
    case: Annotated[Path, given("CASE", "Case file or study file (TOML).")],
) -> None:
    """Validate CASE and print derived quantities, such as the yield velocity; solve nothing."""


@verb("Prepare", "surface")
def surface(case: CaseFile, out: OutFolder, figures: Figures = FigureFormat.png) -> None:
    """Write the surface of CASE to OUT: heights, ISO 25178 statistics, a figure and a page."""


@verb("Compute", "app")
def app(
    case: Annotated[
        Path | None,
        typer.Argument(
            metavar="CASE",
            help="Case file (TOML) that the page shows first.",
            show_default="two rough steel spheres",
            readable=False,
        ),
    ] = None,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port of the page; 0 selects a free port.")
    ] = 0,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
) -> None:
    """Open a page that redraws the curves of CASE while you change its values."""


@verb("Compute", "run")
def run(
    case: CaseFile,
    out: OutFolder,
    device: OnDevice = DeviceName.cpu,
    figures: Figures = FigureFormat.png,
) -> None:
    """Load and unload the contact of CASE; write curves, restitution and figures to OUT."""


@verb("Compute", "run")
def converge(
    case: CaseFile,
    out: OutFolder,
    grids: Annotated[
        int,
        option(
            "N", "Number of grids, each with half the spacing of the previous one.", min=2, max=5
        ),
    ] = 3,
    device: OnDevice = DeviceName.cpu,
    figures: Figures = FigureFormat.png,
) -> None:
    """Run CASE on its grid and on finer grids; write COR and its discretisation error to OUT."""


@verb("Compute", "many")
def study(
    study: Annotated[Path, given("STUDY", "Study file (TOML): a case and a table \\[sweep].")],
    out: OutFolder,
    workers: WorkerCount = None,
    scheduler: Scheduler = None,
    resume: Resume = False,
    retry_failed: Annotated[
        bool, flag("--retry-failed", "With --resume: compute failed cases again, too.")
    ] = False,
) -> None:
    """Run all cases of STUDY; write the results of each case and a table of all to OUT."""


@verb("Compute", "many")
def mixture(
    mixture: Annotated[
        Path, given("MIXTURE", "Mixture file (TOML): materials, sizes, walls and velocities.")
    ],
    out: OutFolder,
    workers: WorkerCount = None,
    scheduler: Scheduler = None,
    resume: Resume = False,
    figures: Figures = FigureFormat.png,
) -> None:
    """Compute the restitution laws of all pairs in MIXTURE, and write them to OUT."""


@verb("Compute", "fit")
def fit(
    measured: Annotated[
        Path,
        given(
            "MEASURED",
            "CSV file with the columns velocity_m_per_s, restitution and, if known, "
            "restitution_std; or depth_nm and hardness_GPa of indents.",
        ),
    ],
    out: OutFolder,
    case: Annotated[
        Path | None,
        option(
            "CASE",
            "Case file (TOML); its values of KEYS are the first guesses.",
            "--case",
            readable=False,
        ),
    ] = None,
    free: Annotated[
        list[str] | None,
        option(
            "KEYS", "Keys of CASE to be fitted, separated by commas, such as yield_strength,rms."
        ),
    ] = None,
    figures: Figures = FigureFormat.png,
) -> None:
    """Find the values of KEYS in CASE that explain the restitution in MEASURED.

    Of indents, find the size effect; they need no CASE and no KEYS.
    """


@verb("Compute", "many")
def reproduce(
    out: OutFolder,
    quick: Annotated[
        bool,
        flag("--quick", "Use smaller grids and fewer cases, which takes about three minutes."),
    ] = False,
    refined: Annotated[
        bool, flag("--refined", "Halve the grid spacing of rough contacts.")
    ] = False,
    workers: WorkerCount = None,
    resume: Resume = False,
) -> None:
    """Compute Figures 5 to 14 of Ghanbarzadeh et al. (2019) and check the claims of the paper."""


@verb("Use results", "results")
def report(
    results: Annotated[
        Path,
        given("RESULTS", "Results folder of a run, periodic contact, study, mixture or surface."),
    ],
    velocity: Annotated[
        str | None,
        option("VELOCITY", 'Impact velocity of the first COR that the page states: "0.5 m/s".'),
    ] = None,
) -> None:
    """Write a self-contained HTML page of the results into the folder RESULTS."""


@verb("Use results", "results")
def compare(
    a: Annotated[Path, given("A", "Results folder of a run or study.")],
    b: Annotated[Path, given("B", "Results folder of the same kind as A.")],
    out: Annotated[Path | None, output("FILE", "New CSV file for the table.")] = None,
) -> None:
    """Print the differences between the results in A and B, and the errors of the differences."""


@verb("Use results", "compare_theory")
def compare_theory(
    case: Annotated[
        Path, given("CASE", "Case file (TOML), or the results folder of a periodic contact.")
    ],
    out: Annotated[
        Path | None,
        output("OUT", "Folder for theory.csv and the figure theory.png; new or empty."),
    ] = None,
    law: Annotated[
        Path | None,
        option(
            "LAW",
            "Folder that `restitution fit-law` wrote for the same pair; adds the computed "
            "points of this law.",
            "--law",
            readable=False,
        ),
    ] = None,
    figures: Figures = FigureFormat.png,
) -> None:
    """Print COR against velocity for the smooth bodies of CASE, from closed-form theories.

    For a periodic contact, print its contact area against nominal pressure, from Persson's theory.
    """


@verb("Use results", "simulate")
def simulate(
    results: Annotated[Path, given("RESULTS", "Results folder of a run.")],
    velocity: Annotated[
        list[str] | None,
        option(
            "VELOCITY",
            'Impact velocity, such as "0.5 m/s"; may be repeated.',
            show_default="the velocities of the unloading curves",
        ),
    ] = None,
    friction: Annotated[
        float | None,
        option(
            "MU",
            "Coefficient of friction, for oblique impacts.",
            min=0.0,
            show_default="the coefficient in the case",
        ),
    ] = None,
    angle: Annotated[
        list[str] | None,
        option(
            "ANGLE",
            'Angle of impact from the normal, such as "30 deg"; may be repeated.',
            show_default="the angles in the case, or head-on",
        ),
    ] = None,
    spin: Annotated[
        list[str] | None,
        option(
            "SPIN",
            'Spin of the first body before the impact, such as "100 rad/s"; a second --spin '
            "is for the second body.",
            show_default="the spins in the case, or none",
        ),
    ] = None,
    out: Annotated[
        Path | None, output("FILE", "New CSV file for indentation, velocity and force over time.")
    ] = None,
) -> None:
    """Integrate collisions in time with the stored forces of RESULTS; compare with stored COR.

    The impacts are oblique if an option gives an angle, a spin or a coefficient of friction, or if
    the case gives an angle or a spin. VELOCITY is then the relative velocity of the centres, and
    the table contains the tangential restitution, the angle of rebound and the spins.
    """


@verb("Use results", "law")
def fit_law(
    results: Annotated[
        Path, given("RESULTS", "Results folder of a run, ensemble or convergence study.")
    ],
    out: Annotated[Path, output("OUT", "Folder for the law; new or empty.")],
    figures: Figures = FigureFormat.png,
) -> None:
    """Write the restitution law of RESULTS to OUT: table, compact fit and fitted force laws."""


@verb("Use results", "law")
def export(
    laws: Annotated[
        list[Path],
        given(
            "LAW",
            "Folders that `restitution fit-law` wrote, one for each pair of particles, or the "
            "folder that `restitution mixture` wrote.",
        ),
    ],
    to: Annotated[
        ExportFormat,
        one_of(
            ExportFormat,
            "--to",
            metavar="CODE",
            help=f"DEM code: {', '.join(ExportFormat)}.",
            show_default=False,
        ),
    ],
    out: Annotated[Path, output("OUT", "Folder for the files.")],
    velocity: Annotated[
        str | None,
        option("VELOCITY", 'Impact velocity, such as "1 m/s"; not needed for c, python and csv.'),
    ] = None,
    coverage: Annotated[
        str | None,
        option(
            "COVERAGE",
            "How many times earlier impacts have covered the surfaces, such as 3, for laws of runs "
            "with many impacts.",
            show_default="the first impact",
        ),
    ] = None,
    size: Annotated[
        float,
        option("FACTOR", "Coarse-grained particles, FACTOR times as large as the computed ones."),
    ] = 1.0,
    units: Annotated[
        UnitSystem, one_of(UnitSystem, "--units", help="Units of the commands, for LAMMPS.")
    ] = UnitSystem.si,
) -> None:
    """Write the input of a DEM code to OUT, with the COR of every pair at VELOCITY.

    c and python are for other codes: a contact with the whole law, in one file.
    """
