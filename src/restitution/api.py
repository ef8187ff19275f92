"""Python functions for complete tasks: run a case, open results, make a law and export it."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restitution.arguments import typed
from restitution.errors import CaseError, OutputError, not_one_of

if TYPE_CHECKING:
    from restitution.case.case import Case
    from restitution.impacts.oblique import ObliqueCollision
    from restitution.impacts.stored_force import StoredForce
    from restitution.laws.law import Law
    from restitution.results.periodic import PeriodicResults
    from restitution.results.reader import RunResults, StudyResults

Folder = str | os.PathLike[str]


@typed
def run(
    case: Folder | Mapping[str, Any],
    *,
    out: Folder | None = None,
    progress: Callable[[str], None] | None = None,
) -> RunResults | PeriodicResults:
    """Run a case, as `restitution run` does, and open its results.

    If the run fails or is interrupted, the depths computed so far are kept in `out`. No figures are
    drawn. Use `on_device` to run on a GPU.

    Args:
        case: Case file, or its tables: `{"first": {"material": "steel", "radius": "500 um"}, …}`.
            File names in these tables are relative to the current folder.
        out: Folder for the results; new or empty. Without it, the results are kept in memory only.
        progress: Function that is called with a short text, such as "3 of 8 depths", at every step
            of the computation.

    Returns:
        The results, as `open_results` reads them. Each warning in them is also issued as a
        `UserWarning`.

    Raises:
        RestitutionError: The case is invalid, `out` is not empty, or the run failed.
    """
    from restitution.case.case_file import naming
    from restitution.results.locking import locked
    from restitution.results.periodic import PeriodicResults
    from restitution.results.writer import ResultsFolder
    from restitution.runs.ensemble import run_realisations
    from restitution.runs.log import ignore

    read, text, name = _read(case)
    folder = None if out is None else Path(out)
    with nullcontext() if folder is None else locked(folder), naming(name):
        target = ResultsFolder(folder)
        run_realisations(read, text, name.parent, target, progress or ignore)
    results = (
        PeriodicResults.of(folder, target.periodic, target.summary, target.dataset)
        if read.periodic
        else target.results
    )
    for warning in results.summary["warnings"]:
        warnings.warn(warning, stacklevel=2)
    return results


def _read(case: Folder | Mapping[str, Any]) -> tuple[Case, str, Path]:
    """Read a case. Return it, its TOML text, and the file name that error messages show."""
    from restitution.case.case_file import naming, parse_case, read_case

    if not isinstance(case, Mapping):
        path = Path(case)
        return *read_case(path), path
    import tomli_w

    name = Path("case")
    with naming(name):
        try:
            text = tomli_w.dumps(case)
        except TypeError as error:
            raise CaseError(
                f"{error}; use only types of values that a case file allows (docs/case-file.md)"
            ) from None
        return parse_case(text), text, name


@typed
def open_results(folder: Folder) -> RunResults | StudyResults | PeriodicResults:
    """Open the stored results of a run, an ensemble, a convergence study or a study of many cases.

    The attribute `dataset` of the results is an xarray Dataset in SI units; `summary` is the
    content of `summary.json`; `curve` is e(V) unless the case is periodic. The dimension of a run
    is `indentation_max` (`depth` if the case is periodic), with the indentation (m) as coordinate:
    `dataset.restitution.sel(indentation_max=1e-7, method="nearest")`. The dimensions of a study are
    `depth` and the swept keys, whose coordinates are SI values:
    `dataset.sel({"roughness.rms": 1e-7}, method="nearest")`; their attribute `as_written` holds the
    values as written in the study file.

    Args:
        folder: Folder that `restitution run`, `converge` or `study` wrote.

    Returns:
        `StudyResults` for a study, `EnsembleResults` for a run on several surfaces,
        `PeriodicResults` for a periodic case, and `RunResults` otherwise.

    Raises:
        OutputError: The folder does not hold results, or a file is damaged.
    """
    from restitution.results.periodic import PeriodicResults
    from restitution.results.reader import StudyResults, read_run
    from restitution.results.tables import is_periodic

    path = Path(folder)
    if is_periodic(path):
        return PeriodicResults(path)
    if (path / "study.toml").is_file():
        return StudyResults(path)
    if not (path / "results.nc").is_file():
        raise OutputError(
            f"{path}: holds no results; give the folder that `restitution run` or `study` wrote"
        )
    results = read_run(path)
    results.check()
    return results


@typed
def law_of(results: Folder | RunResults) -> Law:
    """Make the restitution law and its fits from stored results, as `restitution fit-law` does.

    Args:
        results: Results of a run, ensemble or convergence study, or their folder. If the folder
            already holds a law, this law is read.

    Returns:
        COR and its error at each computed impact velocity.

    Raises:
        CaseError: The results have no impact velocities, for example because a density is missing.
        OutputError: The folder does not hold results, or a file is damaged.
    """
    from restitution.dem.fits import fit_law
    from restitution.laws.law_files import LAW_FILE, read_law
    from restitution.results.reader import RunResults

    if isinstance(results, RunResults):
        return fit_law(results.folder or results)
    folder = Path(results)
    return read_law(folder) if (folder / LAW_FILE).is_file() else fit_law(folder)


@typed
def collide_obliquely(
    results: Folder | RunResults | StoredForce,
    velocity: str | float,
    angle: str | float,
    *,
    friction: float | None = None,
    spin: str | float | tuple[str | float, str | float] = 0.0,
) -> ObliqueCollision:
    """Compute an oblique collision of the two particles of a run, with friction and spin.

    The normal force is taken from the stored curves of loading and unloading. The tangential force
    is computed from the normal force and the coefficient of friction (docs/oblique.md).

    Args:
        results: Results of a run of one surface, their folder, or a force law
            (`restitution.impacts.stored_force.StoredForce`).
        velocity: Relative velocity of the centres, such as "0.5 m/s", or a number (m/s).
        angle: Angle of impact from the normal, such as "30 deg", or a number (rad). It must be at
            least 0 and less than 90 degrees.
        friction: Coefficient of friction (dimensionless). By default, the coefficient in the case
            file of the run is used.
        spin: Spin before the impact: one value for the first body, or a pair of values for both
            bodies. A value is a text such as "100 rad/s" or "20 rpm", or a number (rad/s). A spin
            is positive in the direction in which friction turns a body without spin.

    Returns:
        The collision, with normal and tangential restitution, angle of rebound, spins, losses, and
        time series.

    Raises:
        CaseError: An argument is missing or outside its range, or the pair has adhesion.
        DomainError: The normal velocity lies outside the range of computed velocities.
        OutputError: The folder does not hold results with unloading curves, or a file is damaged.
    """
    from restitution.case.quantities import read_impact_angle, read_quantity
    from restitution.impacts.oblique import collide_obliquely as collide
    from restitution.impacts.oblique import oblique_force
    from restitution.impacts.stored_force import StoredForce
    from restitution.laws.law import velocity_of
    from restitution.results.reader import RunResults, read_run

    if isinstance(results, StoredForce):
        force = results
    else:
        run = results if isinstance(results, RunResults) else read_run(Path(results))
        force = oblique_force(run)
        friction = run.case.interface.friction if friction is None else friction
    if friction is None:
        raise CaseError("friction: not given; an oblique impact needs a coefficient of friction")
    speed = velocity_of(velocity) if isinstance(velocity, str) else velocity
    try:
        slope = read_impact_angle(angle) if isinstance(angle, str) else angle
    except ValueError as error:
        raise CaseError(f"angle: {error}") from None
    both = spin if isinstance(spin, (tuple, list)) else (spin, 0.0)
    try:
        first, second = (
            read_quantity(value, "rad/s") if isinstance(value, str) else value for value in both
        )
    except ValueError as error:
        raise CaseError(f"spin: {error}") from None
    return collide(force, speed, slope, friction, (first, second))


def _laws_in(given: Folder | Law) -> list[Law]:
    """The given law, the law in a folder, or all laws in a mixture's folder."""
    from restitution.laws.law import Law
    from restitution.laws.law_files import is_mixture, read_laws

    if isinstance(given, Law):
        return [given]
    folder = Path(given)
    return read_laws([folder]) if is_mixture(folder) else [law_of(folder)]


@typed
def export(
    laws: Folder | Law | Sequence[Folder | Law],
    *,
    to: str,
    out: Folder,
    velocity: str | float | None = None,
    coverage: float | None = None,
    size: float = 1.0,
    units: str = "si",
) -> list[Path]:
    """Write laws as the input of a DEM code, as `restitution export` does.

    Args:
        laws: One law or several, one for each pair of particles. Each is a `Law`, or a folder that
            holds a law or results (see `law_of`). The folder of a mixture gives all of its laws.
        to: DEM code ("lammps", "liggghts", "yade", "mercurydpm", "edem", "kratos", "mujoco",
            "drake", "lammps-adhesive", "liggghts-adhesive", "yade-adhesive"), "c" or "python"
            for other codes, or "csv" to write a table.
        out: Folder for the files; existing files are never overwritten.
        velocity: Impact velocity, such as "1 m/s", or a number (m/s). It is optional for
            "c", "python" and "csv".
        coverage: How many times earlier impacts have covered the surfaces (dimensionless); None for
            the first impact. The cases need the table [impacts].
        size: Coarse-grained particles are this many times as large as the computed ones, with the
            same e(V) (dimensionless).
        units: Units of the commands for LAMMPS: "si", "cgs" or "micro".

    Returns:
        The files that were written.

    Raises:
        CaseError: The DEM code is unknown, it does not accept these laws, or it needs a velocity
            and none is given.
        DomainError: The velocity lies outside the range of computed velocities.
        OutputError: A file exists, or cannot be read or written.
    """
    from restitution.dem.export import CODES, write_export
    from restitution.dem.export import export as export_texts
    from restitution.dem.fits import with_fits
    from restitution.laws.coverage import at_coverage
    from restitution.laws.law import Law, velocity_of

    if to not in CODES:
        raise CaseError(f"to={not_one_of(to, CODES)}")
    given = [laws] if isinstance(laws, (str, os.PathLike, Law)) else laws
    read = [law for item in given for law in _laws_in(item)]
    if coverage is not None:
        read = [with_fits(at_coverage(law, coverage)) for law in read]
    speed = velocity_of(velocity) if isinstance(velocity, str) else velocity
    return write_export(export_texts(read, to, speed, size=size, units=units), Path(out))
