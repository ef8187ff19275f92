"""Compute the cases of a study in parallel, and store each case as soon as it is complete."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from dataclasses import dataclass, field
from pathlib import Path

from restitution.errors import OutputError, one_line
from restitution.results.interruption import hold_signals
from restitution.sweeps.executors import Outcome, Workers, compute
from restitution.sweeps.study_folder import StudyFolder
from restitution.sweeps.sweep import Study, SweptCase

_POLL = 0.2  # time between updates of the progress (s)
_DEATHS = 3  # a case has failed if its worker died this many times


@dataclass
class Tally:
    """Numbers of cases; `in_flight` is the number of completed depths of each running case."""

    cases: int
    done: int = 0
    failed: int = 0
    in_flight: dict[int, int] = field(default_factory=dict)


def run_study(
    study: Study,
    folder: Path,
    out: StudyFolder,
    workers: Workers,
    progress: Callable[[Tally], None] = lambda _: None,
    *,
    retry_failed: bool = False,
) -> Tally:
    """Compute every case of `study` that `out` does not hold yet, and write the tables of `out`.

    Paths of scans are relative to `folder`. A failed case is stored with the reason, and computed
    again only with `retry_failed`. Completed cases are kept whatever happens. A case whose worker
    dies is computed again, alone, and has failed after the third death.
    """
    out.clear()
    known = {case.number: out.reason(case) for case in study.cases}
    missing = [
        case
        for case in study.cases
        if known[case.number] is None or (retry_failed and known[case.number])
    ]
    tally = Tally(
        len(study.cases),
        done=len(study.cases) - len(missing),
        failed=0 if retry_failed else sum(map(bool, known.values())),
    )
    progress(tally)
    try:
        _compute_all(deque(missing), folder, out, workers, tally, progress)
    finally:
        with hold_signals():
            out.write_tables()
    return tally


def _compute_all(
    waiting: deque[SweptCase],
    folder: Path,
    out: StudyFolder,
    workers: Workers,
    tally: Tally,
    progress: Callable[[Tally], None],
) -> None:
    executor, size, deaths = workers.executor, workers.places, Counter[int]()
    suspects: deque[SweptCase] = deque()
    running: dict[Future[Outcome], SweptCase] = {}
    broken = False
    while waiting or suspects or running:
        # Cases whose worker died run alone, so that a faulty case does not stop other cases.
        places = 1 if suspects else workers.places
        if broken or (places != size and not running):
            executor, size, broken = workers.renewed(places), places, False
        source = suspects or waiting
        while source and len(running) < min(places, size):
            case = source[0]
            try:
                future = executor.submit(
                    compute, case.text, str(folder), case.number, workers.threads, workers.channel
                )
            except BrokenExecutor:  # a worker has died since the last check
                broken = True
                break
            running[future] = source.popleft()
            tally.in_flight[case.number] = 0
        done, _ = wait(running, timeout=_POLL, return_when=FIRST_COMPLETED)
        for future in done:
            case = running.pop(future)
            del tally.in_flight[case.number]
            try:
                outcome = future.result()
            except BrokenExecutor:
                broken = True
                deaths[case.number] += 1
                if deaths[case.number] < _DEATHS:
                    suspects.append(case)
                    continue
                outcome = Outcome({}, f"its worker died {_DEATHS} times: killed, or out of memory")
            except OutputError:  # such as a full disk, which concerns all cases
                raise
            except Exception as error:  # a bug, or an error of the cluster: only this case fails
                outcome = Outcome({}, one_line(f"{type(error).__name__}: {error}"))
            out.put(case, outcome)
            tally.done += 1
            tally.failed += bool(outcome.reason)
        if broken:
            # The other running cases were lost with the executor.
            suspects.extend(running.values())
            running.clear()
            tally.in_flight.clear()
        for number, depths in workers.heard():
            if number in tally.in_flight:
                tally.in_flight[number] = depths
        progress(tally)
