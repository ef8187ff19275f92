"""All laws of a mixture from as few runs as the error of interpolation allows, and their files.

Each family begins with laws at the smallest, a middle and the largest R*. Where the interpolation
error of a pair exceeds its limit, a law at one more R* is computed, until none does.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from restitution.display import some_of, without_numbers
from restitution.errors import OutputError
from restitution.laws.coverage import at_coverage
from restitution.laws.from_results import bare_law
from restitution.laws.law import Law, LawPoint
from restitution.laws.law_files import LAWS, MIXTURE_FILE, write_law
from restitution.mixtures.family import Family, ParticlePair, families
from restitution.mixtures.mixture_file import Mixture
from restitution.mixtures.scaling import FamilyLaws
from restitution.results.writer import write_json, write_table, writing
from restitution.sweeps.executors import Workers
from restitution.sweeps.scheduler import Tally, run_study
from restitution.sweeps.study_folder import STUDY_FILE, StudyFolder, prepare_folder
from restitution.sweeps.sweep import Study, SweptCase

RUNS, PAIRS = "runs", "pairs.csv"
Progress = Callable[[Tally], None]


@dataclass(frozen=True)
class PairLaw:
    """The law of one pair of particles, `computed` or interpolated.

    `interpolation_error` is the error of COR due to interpolation, 0 for a computed law.
    """

    law: Law
    computed: bool
    interpolation_error: float


def run_mixture(
    mixture: Mixture,
    folder: Path,
    out: StudyFolder,
    workers: Workers,
    progress: Progress,
) -> list[PairLaw]:
    """Compute the law of every pair of `mixture`, with scans relative to `folder`.

    Runs are stored as the cases of a study in `out`, which can be resumed. Raises `OutputError` if
    a run fails.
    """
    all_families = families(mixture)
    cases: dict[tuple[str, float], SweptCase] = {}
    wanted = [(family, radius) for family in all_families for radius in _first_radii(family)]
    while wanted:
        for family, radius in wanted:
            values = {"pair": family.name, "reduced_radius": f"{1e6 * radius:.6g} um"}
            case = SweptCase(len(cases) + 1, values, family.case(radius))
            cases[family.name, radius] = case
        _run_all(tuple(cases.values()), folder, out, workers, progress)
        computed = [_computed(family, cases, out) for family in all_families]
        wanted = [(laws.family, radius) for laws in computed for radius in _more_radii(laws)]
    return [_pair_law(laws, pair) for laws in computed for pair in laws.family.pairs]


def _run_all(
    cases: tuple[SweptCase, ...],
    folder: Path,
    out: StudyFolder,
    workers: Workers,
    progress: Progress,
) -> None:
    swept = {name: [case.values[name] for case in cases] for name in cases[0].values}
    out.study = replace(out.study, swept=swept, cases=cases)
    run_study(out.study, folder, out, workers, progress)
    for case in cases:
        if reason := out.reason(case):
            raise OutputError(
                f"{out.folder_of(case)}: the run of {case.values['pair']} at R* = "
                f"{case.values['reduced_radius']} failed: {reason}"
            )


def _computed(
    family: Family, cases: Mapping[tuple[str, float], SweptCase], out: StudyFolder
) -> FamilyLaws:
    radii = sorted(radius for name, radius in cases if name == family.name)
    folders = [out.folder_of(cases[family.name, radius]) for radius in radii]
    laws, coverage = list(map(bare_law, folders)), family.mixture.coverage
    if coverage is not None:
        laws = [at_coverage(law, coverage) for law in laws]
    return FamilyLaws(family, tuple(laws))


def _first_radii(family: Family) -> list[float]:
    radii = family.radii
    middle = _nearest(radii, float(np.sqrt(radii[0] * radii[-1])))
    return sorted({radii[0], middle, radii[-1]})


def _more_radii(computed: FamilyLaws) -> Iterator[float]:
    """One R* (m) between two computed ones, where a pair has too large an interpolation error."""
    family = computed.family
    poor = {pair.radius for pair in family.pairs if not computed.is_good(pair)}
    for low, high in zip(computed.radii[:-1], computed.radii[1:], strict=True):
        if any(low < radius < high for radius in poor):
            inside = [r for r in family.radii if low < r < high and not computed.has(r)]
            yield _nearest(inside, float(np.sqrt(low * high)))


def _nearest(radii: Sequence[float], radius: float) -> float:
    return radii[int(np.abs(np.log(np.array(radii) / radius)).argmin())]


def _pair_law(computed: FamilyLaws, pair: ParticlePair) -> PairLaw:
    return PairLaw(
        computed.law(pair),
        computed.has(pair.radius),
        max(computed.interpolation_errors(pair)),
    )


def open_mixture_folder(out: Path, mixture: Mixture, *, resume: bool) -> StudyFolder:
    """Open the folder in `out` that holds the runs of `mixture`.

    Raises `OutputError` if `out` holds other files or nothing to resume, or cannot be written.
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
    """Write the laws of all `pairs`, a table of them, and the summary; return their names.

    `runs` is the number of computed curves, which took `seconds`. Raises `OutputError`.
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
                **_covered(pair.law, point),
            }
            for point in pair.law.points
        ]
    write_table(out / PAIRS, rows)
    write_json(
        out / "summary.json",
        {
            "title": mixture.title,
            "coverage": mixture.coverage,
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


def _covered(law: Law, point: LawPoint) -> dict[str, float]:
    """Columns of laws at a coverage."""
    if law.coverage is None:
        return {}
    return {"coverage": law.coverage, "restitution_std": point.deviation or 0.0}


def condensed_warnings(pairs: Sequence[PairLaw]) -> list[str]:
    """Each warning once, with its pairs; warnings that differ only in numbers count as one."""
    groups: dict[str, list[tuple[str, str]]] = {}
    for pair in pairs:
        family = f"{pair.law.first.name}+{pair.law.second.name}"
        for warning in dict.fromkeys(pair.law.warnings):
            groups.setdefault(without_numbers(warning), []).append((family, warning))
    return [
        f"{len(of)} of {len(pairs)} pairs ({some_of([family for family, _ in of])}): {of[0][1]}"
        + ("" if len({text for _, text in of}) == 1 else " (with other numbers in other pairs)")
        for of in groups.values()
    ]
