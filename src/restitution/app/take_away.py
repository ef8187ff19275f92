"""Files that the user downloads: case, figures, results, law, DEM export, report."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from zipfile import ZIP_DEFLATED, ZipFile

from restitution.api import export, law_of
from restitution.app.content import content_of, scans_of
from restitution.errors import CaseError
from restitution.laws.law_files import write_law
from restitution.pages.report import write_report
from restitution.plots.law import law_figure
from restitution.plots.run import run_figures
from restitution.plots.run_in import run_in_figures
from restitution.plots.static import Format, write_figure, write_figures
from restitution.results.reader import read_run

FIGURE_FORMATS: tuple[Format, ...] = ("svg", "png", "pdf")
CASE_FILE = "case.toml"
_BESIDE = {"", ".md", ".json"}  # suffixes of folders and of files beside the main one of an export
_COMMENTS = ("#", "//", "<!--")


def case_file(text: str, scans: Path, out: Path) -> Path:
    """Write the case file into `out`. If it names scans, write a zip archive that includes them."""
    names = [table["file"] for table in scans_of(content_of(text))]
    if not names:
        (out / CASE_FILE).write_text(text, encoding="utf-8")
        return out / CASE_FILE
    archive = out / "case.zip"
    with ZipFile(archive, "w", ZIP_DEFLATED) as into:
        into.writestr(CASE_FILE, text)
        for name in dict.fromkeys(names):
            into.write(scans / name, name)
    return archive


def take(what: str, results: Path, out: Path, code: str, velocity: str) -> Path:
    """Write the download `what` from the folder `results` into `out`; return the file.

    Only "export" uses `code` (the DEM code) and `velocity` (the impact velocity, or ""); after
    many impacts, it is of the largest coverage.
    """
    if what == "report":
        return Path(shutil.copy(write_report(results), out))
    if what == "export":
        return _zipped(
            out / f"{code}.zip",
            lambda folder: _export(results, code, velocity, folder / "export"),
        )
    if what not in _ARCHIVES:
        raise CaseError(f'"{what}" is not one of case, export, {", ".join(_ARCHIVES)}, report')
    return _zipped(out / f"{what}.zip", partial(_ARCHIVES[what], results))


def lines_of(results: Path, code: str, velocity: str) -> tuple[str, str]:
    """The main file of an export: its name, and its lines without comments and empty lines."""
    with TemporaryDirectory() as name:
        out = Path(name) / "export"
        _export(results, code, velocity, out)
        files = (path for path in sorted(out.rglob("*")) if path.suffix not in _BESIDE)
        file = max(files, key=lambda path: path.name.startswith("restitution"))
        lines = file.read_text(encoding="utf-8").splitlines()
    said = (line for line in lines if line.strip() and not line.lstrip().startswith(_COMMENTS))
    return file.name, "\n".join(said)


def _export(results: Path, code: str, velocity: str, out: Path) -> None:
    given = velocity or None
    export(results, to=code, out=out, velocity=given, coverage=_coverage(results))


def _coverage(results: Path) -> float | None:
    """The largest coverage that all velocities of a run have reached; None: the first impact."""
    reached: dict[float, float] = {}
    for point in read_run(results).run_in:
        reached[point.velocity] = max(point.coverage, reached.get(point.velocity, 0.0))
    return min(reached.values(), default=None)


def _figures(results: Path, folder: Path) -> None:
    run = read_run(results)
    for kind in FIGURE_FORMATS:
        write_figures(folder, [*run_figures(run.dataset), *run_in_figures(run)], kind)
    for table in results.glob("*.csv"):
        shutil.copy(table, folder)


def _results(results: Path, folder: Path) -> None:
    shutil.copytree(results, folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns(".*"))


def _law(results: Path, folder: Path) -> None:
    law = law_of(results)
    write_law(law, folder / "law")
    write_figure(folder / "law" / "law", law_figure(law), "svg")


# The downloads that are zip archives, with the functions that write their files into a folder.
_ARCHIVES: dict[str, Callable[[Path, Path], None]] = {
    "figures": _figures,
    "results": _results,
    "law": _law,
}


def _zipped(archive: Path, fill: Callable[[Path], object]) -> Path:
    with TemporaryDirectory() as name:
        folder = Path(name)
        fill(folder)
        with ZipFile(archive, "w", ZIP_DEFLATED) as into:
            for file in sorted(path for path in folder.rglob("*") if path.is_file()):
                into.write(file, file.relative_to(folder).as_posix())
    return archive
