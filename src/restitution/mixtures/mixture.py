"""Compute all laws of a mixture from as few runs as the error of interpolation allows.

All pairs of two components (materials or walls) are a family. Each family is first computed at its
smallest, a middle and its largest reduced radius. If the interpolation error of a pair exceeds the
limit, another radius is computed, in the middle between the neighbouring computed radii. This is
repeated until no error exceeds the limit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from restitution.errors import OutputError
from restitution.laws.from_results import bare_law
from restitution.laws.law import Law
from restitution.mixtures.family import Family, Meeting, families
from restitution.mixtures.mixture_file import Mixture
from restitution.mixtures.scaling import Computed
from restitution.sweeps.executors import Workers
from restitution.sweeps.scheduler import Tally, run_study
from restitution.sweeps.study_folder import StudyFolder
from restitution.sweeps.sweep import Study, SweptCase

Progress = Callable[[Tally], None]


@dataclass(frozen=True)
class PairLaw:
    """The law of one pair of particles, and its interpolation error (0 if `computed`)."""

    meeting: Meeting
    law: Law
    computed: bool
    interpolation_error: float


def empty_study(mixture: Mixture) -> Study:
    """Make the study of a mixture before its first round, without cases."""
    return Study(mixture.title, mixture.text, {"pair": [], "reduced_radius": []}, "paired", ())


def run_mixture(
    mixture: Mixture,
    folder: Path,
    out: StudyFolder,
    workers: Workers,
    progress: Progress,
) -> list[PairLaw]:
    """Compute the law of every pair of `mixture`.

    Paths of scans are relative to `folder`. Runs are stored as the cases of a study in `out`, so
    that an interrupted mixture can be resumed. Raises `OutputError` if a run fails, because some
    pairs would then have no law.
    """
    rounds = _Rounds(mixture, folder, out, workers, progress)
    found = families(mixture)
    wanted = [(family, radius) for family in found for radius in _first_radii(family)]
    while wanted:
        rounds.compute(wanted)
        wanted = [(family, r) for family in found for r in _more_radii(rounds.computed(family))]
    return [pair for family in found for pair in _laws(rounds.computed(family))]


class _Rounds:
    """The runs of a mixture, computed round by round."""

    def __init__(
        self,
        mixture: Mixture,
        folder: Path,
        out: StudyFolder,
        workers: Workers,
        progress: Progress,
    ) -> None:
        self._mixture, self._folder, self._out = mixture, folder, out
        self._workers, self._progress = workers, progress
        self._cases: dict[tuple[str, float], SweptCase] = {}

    def compute(self, wanted: list[tuple[Family, float]]) -> None:
        """Run the case of each family and reduced radius (m) in `wanted`."""
        for family, radius in wanted:
            values = {"pair": family.name, "reduced_radius": f"{1e6 * radius:.6g} um"}
            case = SweptCase(len(self._cases) + 1, values, family.case(radius))
            self._cases[family.name, radius] = case
        cases = tuple(self._cases.values())
        swept = {name: [case.values[name] for case in cases] for name in cases[0].values}
        study = Study(self._mixture.title, self._mixture.text, swept, "paired", cases)
        self._out.study = study
        run_study(study, self._folder, self._out, self._workers, self._progress)
        for case in cases:
            if reason := self._out.reason(case):
                raise OutputError(
                    f"{self._out.folder_of(case)}: the run of {case.values['pair']} at R* = "
                    f"{case.values['reduced_radius']} failed: {reason}"
                )

    def computed(self, family: Family) -> Computed:
        """Return the laws of `family` that have been computed so far."""
        radii = sorted(radius for name, radius in self._cases if name == family.name)
        folders = [self._out.folder_of(self._cases[family.name, radius]) for radius in radii]
        return Computed(family, tuple(map(bare_law, folders)))


def _first_radii(family: Family) -> list[float]:
    radii = family.radii
    middle = radii[_nearest(radii, float(np.sqrt(radii[0] * radii[-1])))]
    return sorted({radii[0], middle, radii[-1]})


def _more_radii(computed: Computed) -> Iterator[float]:
    """Yield reduced radii (m) to compute next.

    Between two neighbouring computed radii, one radius is chosen if an error there is too large.
    """
    family = computed.family
    poor = {meeting.radius for meeting in family.meetings if not computed.is_good(meeting)}
    for low, high in zip(computed.radii[:-1], computed.radii[1:], strict=True):
        if any(low < radius < high for radius in poor):
            inside = [radius for radius in family.radii if low < radius < high]
            inside = [radius for radius in inside if not computed.has(radius)]
            yield inside[_nearest(inside, float(np.sqrt(low * high)))]


def _nearest(radii: list[float] | tuple[float, ...], radius: float) -> int:
    return int(np.abs(np.log(np.array(radii) / radius)).argmin())


def _laws(computed: Computed) -> Iterator[PairLaw]:
    for meeting in computed.family.meetings:
        yield PairLaw(
            meeting,
            computed.law(meeting),
            computed.has(meeting.radius),
            max(computed.interpolation_errors(meeting)),
        )
