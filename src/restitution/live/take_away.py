"""Files that the user downloads: case, figures, results, law, DEM export, report."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from zipfile import ZIP_DEFLATED, ZipFile

from restitution.api import export, law_of
from restitution.errors import CaseError
from restitution.laws.law_files import write_law
from restitution.live.content import content_of, scans_of
from restitution.pages.report import write_report
from restitution.plots.law import law_figure
from restitution.plots.run import run_figures
from restitution.plots.static import Format, write_figure, write_figures
from restitution.results.reader import read_run

FIGURE_FORMATS: tuple[Format, ...] = ("svg", "png", "pdf")
CASE_FILE = "case.toml"


def case_file(text: str, scans: Path, out: Path) -> Path:
    """Write the case file into `out`, or a zip archive of the case file and its scans."""
    names = scans_of(content_of(text))
    if not names:
        (out / CASE_FILE).write_text(text, encoding="utf-8")
        return out / CASE_FILE
    archive = out / "case.zip"
    with ZipFile(archive, "w", ZIP_DEFLATED) as into:
        into.writestr(CASE_FILE, text)
        for name in dict.fromkeys(names):
            into.write(scans / name, name)
    return archive


def figure_files(results: Path, out: Path) -> Path:
    """Write every figure in all formats, and the tables, into a zip archive in `out`."""

    def fill(folder: Path) -> None:
        run = read_run(results)
        for kind in FIGURE_FORMATS:
            write_figures(folder, run_figures(run.dataset), kind)
        for table in results.glob("*.csv"):
            shutil.copy(table, folder)

    return _zipped(out / "figures.zip", fill)


def results_files(results: Path, out: Path) -> Path:
    """Write the whole results folder into a zip archive in `out`."""
    return _zipped(out / "results.zip", lambda to: _copy(results, to))


def law_files(results: Path, out: Path) -> Path:
    """Write the restitution law with its fits and figure into a zip archive in `out`."""

    def fill(folder: Path) -> None:
        law = law_of(results)
        write_law(law, folder / "law")
        write_figure(folder / "law" / "law", law_figure(law), "svg")

    return _zipped(out / "law.zip", fill)


def export_files(results: Path, out: Path, code: str, velocity: str) -> Path:
    """Write the input of a DEM code at an impact velocity into a zip archive in `out`."""

    def fill(folder: Path) -> None:
        export(results, to=code, out=folder / "export", velocity=velocity or None)

    return _zipped(out / f"{code}.zip", fill)


def report_page(results: Path, out: Path) -> Path:
    """Write the report page `report.html` into `out`."""
    shutil.copy(write_report(results), out / "report.html")
    return out / "report.html"


OF_RESULTS: dict[str, Callable[[Path, Path], Path]] = {
    "figures": figure_files,
    "results": results_files,
    "law": law_files,
    "report": report_page,
}


def take(what: str, results: Path, out: Path, code: str, velocity: str) -> Path:
    """Write the download `what` from the folder `results` into `out`; return the file.

    Raises `CaseError` if `what` is unknown.
    """
    if what == "export":
        return export_files(results, out, code, velocity)
    if what not in OF_RESULTS:
        raise CaseError(f'"{what}" is not one of case, export, {", ".join(OF_RESULTS)}')
    return OF_RESULTS[what](results, out)


def _zipped(archive: Path, fill: Callable[[Path], None]) -> Path:
    """Make a zip archive of the files that `fill` writes into a folder."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        fill(folder)
        with ZipFile(archive, "w", ZIP_DEFLATED) as into:
            for file in sorted(path for path in folder.rglob("*") if path.is_file()):
                into.write(file, file.relative_to(folder).as_posix())
    return archive


def _copy(results: Path, folder: Path) -> None:
    shutil.copytree(results, folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns(".*"))
