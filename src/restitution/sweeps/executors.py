"""Processes that compute cases, on this machine or on a Dask cluster."""

from __future__ import annotations

import itertools
import multiprocessing
import os
import signal
import tempfile
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from multiprocessing.managers import SyncManager
from pathlib import Path
from typing import Any, Protocol

from restitution.errors import CaseError, OutputError, RestitutionError, one_line
from restitution.results.interruption import hold_signals

PATIENCE = "15s"  # timeout of the connection to a Dask scheduler


class Channel(Protocol):
    """A channel for the messages of a worker about its progress."""

    def put(self, message: tuple[int, int], /) -> object:
        """Send the number of a case, and the number of its depths done."""


@dataclass(frozen=True)
class Outcome:
    """The files of the results folder of a case, and the `reason` if it failed, else "".

    A failed case has only the files that were written before the failure.
    """

    files: dict[str, bytes]
    reason: str


@dataclass(frozen=True)
class Workers:
    """An executor that computes `places` cases at a time, each with `threads` threads.

    After a process has died, `renewed` makes a new executor for a number of cases at a time.
    `heard` returns the messages that arrived through `channel` since its last call.
    """

    executor: Executor
    places: int
    threads: int
    channel: Channel
    heard: Callable[[], list[tuple[int, int]]]
    renewed: Callable[[int], Executor]


def chosen_workers(count: int | None, scheduler: str | None) -> AbstractContextManager[Workers]:
    """Workers of the Dask cluster at `scheduler`, or `count` processes. Raises `CaseError`."""
    if scheduler is not None and count is not None:
        raise CaseError(
            "--workers, --scheduler: give only one of them; --workers is the number of processes "
            "on this machine"
        )
    return cluster_workers(scheduler) if scheduler else local_workers(count)


@contextmanager
def local_workers(count: int | None) -> Iterator[Workers]:
    """`count` processes that share the cores of this machine; by default one per core."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    places = count or cores or 1
    threads = max(1, (cores or 1) // places)
    # Spawn processes, because a fork would copy locks that other threads hold.
    context = multiprocessing.get_context("spawn")
    manager = SyncManager(ctx=context)
    with hold_signals(), _without_interrupts():
        manager.start(_serve)
    with manager, ExitStack() as pools:
        queue = manager.Queue()

        def begin(size: int) -> Executor:
            return pools.enter_context(_Pool(size, mp_context=context, initializer=_serve))

        def heard() -> list[tuple[int, int]]:
            # No other process takes messages, so at least `qsize()` messages can be taken.
            return [queue.get_nowait() for _ in range(queue.qsize())]

        yield Workers(begin(places), places, threads, queue, heard, begin)


class _Pool(ProcessPoolExecutor):
    """Ctrl-C is blocked in its processes, which start when tasks are submitted.

    At the end of a `with` body, running cases are stopped: nothing would store their results.
    """

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        with _without_interrupts():
            return super().submit(function, *args, **kwargs)

    def __exit__(self, *_: object) -> None:
        with hold_signals():
            for process in list((self._processes or {}).values()):
                process.terminate()
            self.shutdown(cancel_futures=True)


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Block SIGINT in processes that start in the `with` body.

    Ctrl-C sends SIGINT to all processes of a terminal. Until a new process has called `_serve`, an
    unblocked SIGINT would end it with a traceback.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows lacks this function
        yield
        return
    from multiprocessing import resource_tracker

    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        # Starting the resource tracker unblocks SIGINT. Therefore, start it now, and not together
        # with the first new process. The tracker starts with SIGHUP blocked, because it must
        # outlive this process when the terminal closes.
        resource_tracker.ensure_running()
        signal.pthread_sigmask(signal.SIG_SETMASK, before | {signal.SIGINT})
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _serve() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def end_with_parent() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=end_with_parent, daemon=True).start()


@contextmanager
def cluster_workers(address: str) -> Iterator[Workers]:
    """The workers of the Dask cluster whose scheduler is at `address`. Raises `OutputError`."""
    try:
        from distributed import Client, Queue
    except ImportError:
        raise OutputError(
            'scheduler: Dask is not installed; run `pip install ".[cluster]"` in a checkout'
        ) from None
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise OutputError(
            f"scheduler: {address} does not answer ({error}); start a scheduler with "
            "`dask scheduler`"
        ) from None
    with client:
        places = sum(client.ncores().values())
        if not places:
            raise OutputError(
                f"scheduler: {address} has no workers; start workers with `dask worker {address}`"
            )
        queue = Queue(client=client)

        def heard() -> list[tuple[int, int]]:
            return [(number, done) for number, done in queue.get(batch=True)]

        # No new executor is needed after a worker has died, because Dask itself repeats the task (a
        # limited number of times).
        executor = client.get_executor(pure=False)
        yield Workers(executor, places, 1, queue, heard, lambda _: executor)


def compute(text: str, folder: str, number: int, threads: int, channel: Channel) -> Outcome:
    """Run the case file `text` in this process; paths in it are relative to `folder`.

    Results are returned, so workers need no shared disk, and only the main process writes.
    """
    # DUCC0 reads this variable only once per process, before its first transform.
    os.environ.setdefault("DUCC0_NUM_THREADS", str(threads))
    from restitution.case.case_file import parse_case
    from restitution.results.writer import ResultsFolder
    from restitution.runs.ensemble import run_realisations

    depths, reason = itertools.count(1), ""

    def progress(_: str) -> None:
        channel.put((number, next(depths)))

    with tempfile.TemporaryDirectory(prefix="restitution-") as temporary:
        out = Path(temporary) / "case"
        try:
            run_realisations(parse_case(text), text, Path(folder), ResultsFolder(out), progress)
        except OutputError:
            raise
        except RestitutionError as error:
            reason = one_line(str(error))
        except MemoryError:
            reason = "the memory is too small for this case; use fewer grid.nodes"
        files = {
            path.relative_to(out).as_posix(): path.read_bytes()
            for path in sorted(out.rglob("*"))
            if path.is_file()
        }
    return Outcome(files, reason)
