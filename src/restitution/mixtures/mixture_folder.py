"""The folder of a mixture: its runs, the law of every pair, and one table of all laws."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from restitution.display import some_of, without_numbers
from restitution.laws.law_files import LAWS, MIXTURE_FILE, write_law
from restitution.mixtures.mixture import PairLaw
from restitution.mixtures.mixture_file import Mixture
from restitution.results.writer import write_json, write_table, writing
from restitution.sweeps.study_folder import STUDY_FILE, StudyFolder, prepare_folder
from restitution.sweeps.sweep import Study

RUNS, PAIRS = "runs", "pairs.csv"


def open_mixture_folder(out: Path, mixture: Mixture, *, resume: bool) -> StudyFolder:
    """Open the folder in `out` that holds the runs of `mixture`.

    Raises `OutputError` if `out` holds other files, if there is nothing to resume, or if `out`
    cannot be written.
    """
    prepare_folder(out, MIXTURE_FILE, mixture.text, resume=resume, what="mixture")
    begun = (out / RUNS / STUDY_FILE).is_file()
    without_cases = Study(
        mixture.title, mixture.text, {"pair": [], "reduced_radius": []}, "paired", ()
    )
    return StudyFolder(out / RUNS, without_cases, resume=begun)


def write_mixture(
    out: Path, mixture: Mixture, pairs: Sequence[PairLaw], runs: int, seconds: float
) -> list[str]:
    """Write the laws of all `pairs`, a table of these laws, and the summary.

    `runs` is the number of computed curves, and `seconds` the time for computing them. Returns the
    names of the files and folders in `out`. Raises `OutputError`.
    """
    with writing(out):
        shutil.rmtree(out / LAWS, ignore_errors=True)
        (out / LAWS).mkdir()
    rows: list[dict[str, float | str]] = []
    for number, pair in enumerate(pairs, 1):
        name = f"pair-{number:03d}"
        write_law(pair.law, out / LAWS / name)
        rows += [
            {
                "law": name,
                "first": pair.law.first.name,
                "first_radius_m": pair.law.first.radius or float("inf"),
                "second": pair.law.second.name,
                "second_radius_m": pair.law.second.radius or float("inf"),
                "reduced_radius_m": pair.law.radius,
                "reduced_mass_kg": pair.law.mass,
                "computed": pair.computed,
                "velocity_m_per_s": point.velocity,
                "restitution": point.restitution,
                "restitution_error": point.error,
                "resolved": point.resolved,
            }
            for point in pair.law.points
        ]
    write_table(out / PAIRS, rows)
    write_json(
        out / "summary.json",
        {
            "title": mixture.title,
            "pairs": len(pairs),
            "curves_computed": runs,
            "pairs_interpolated": sum(not pair.computed for pair in pairs),
            "largest_interpolation_error": max(pair.interpolation_error for pair in pairs),
            "largest_restitution_error": max(
                point.error for pair in pairs for point in pair.law.points
            ),
            "warnings": condensed_warnings(pairs),
            "seconds": round(seconds, 1),
        },
    )
    return [LAWS, MIXTURE_FILE, PAIRS, RUNS, "summary.json"]


def condensed_warnings(pairs: Sequence[PairLaw]) -> list[str]:
    """List each warning once, with its pairs.

    Warnings that differ only in numbers count as one.
    """
    found: dict[str, list[tuple[str, str]]] = {}
    for pair in pairs:
        family = f"{pair.law.first.name}+{pair.law.second.name}"
        for warning in dict.fromkeys(pair.law.warnings):
            found.setdefault(without_numbers(warning), []).append((family, warning))
    return [
        f"{len(of)} of {len(pairs)} pairs ({some_of([family for family, _ in of])}): {of[0][1]}"
        + ("" if len({text for _, text in of}) == 1 else " (with other numbers in other pairs)")
        for of in found.values()
    ]
