"""How much memory this process may take, and refusing what takes more."""

from __future__ import annotations

import math
import os
from pathlib import Path

from restitution.errors import CaseError

_PAGE = 2**12  # a limit above half of all addresses is none, rounded to pages
_GROUPS = Path("/sys/fs/cgroup")


def available() -> float:
    """Bytes that this process may take in all: of the machine, its control groups and its limits.

    Infinite where the system does not tell.
    """
    return min(_of_machine(), _of_control_groups(), _of_address_space())


def require(needed: float, what: str, remedy: str) -> None:
    """Raise `CaseError` where `what` takes `needed` bytes in all, and there are fewer."""
    there = available()
    if needed > there:
        raise CaseError(
            f"{what} take about {in_words(needed)} of memory, and {in_words(there)} are there; "
            f"{remedy}"
        )


def in_words(size: float) -> str:
    """So many bytes as a message says them."""
    return f"{size / 1e9:.3g} GB" if size >= 1e9 else f"{size / 1e6:.0f} MB"


def _of_machine() -> float:
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return math.inf


def _of_control_groups(groups: str = "/proc/self/cgroup") -> float:
    """The least limit of the control groups of this process and of those above them."""
    least = math.inf
    try:
        lines = Path(groups).read_text(encoding="utf-8").splitlines()
    except OSError:
        return least
    for line in lines:
        _, first, rest = line.partition(":")
        controllers, second, path = rest.partition(":")
        if not (first and second):
            continue
        if controllers == "":  # version 2
            root, file = _GROUPS, "memory.max"
        elif "memory" in controllers.split(","):  # version 1
            root, file = _GROUPS / "memory", "memory.limit_in_bytes"
        else:
            continue
        group = root / path.lstrip("/")
        # In a container the path may be the host's, which is not there: its root is.
        for folder in (group, *group.parents):
            least = min(least, _limit(folder / file))
            if folder == root:
                break
    return least


def _limit(file: Path) -> float:
    try:
        limit = float(file.read_text(encoding="ascii"))
    except (OSError, ValueError):  # none, or "max"
        return math.inf
    return limit if limit < 2**63 - _PAGE else math.inf


def _of_address_space() -> float:
    """What `ulimit -v` leaves, less the addresses that are taken and hold nothing."""
    try:
        import resource
    except ImportError:
        return math.inf
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return math.inf
    try:
        pages = Path("/proc/self/statm").read_text(encoding="ascii").split()
    except OSError:
        return float(limit)
    reserved, resident = (int(p) * os.sysconf("SC_PAGE_SIZE") for p in pages[:2])
    return float(max(limit - reserved + resident, 0))
