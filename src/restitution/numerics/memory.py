"""The memory available to this process, and the check before something large is made."""

from __future__ import annotations

import math
import os
from pathlib import Path

from restitution.errors import CaseError

_PAGE = 2**12  # a limit above half of all addresses, rounded to pages, means no limit
_GROUPS = Path("/sys/fs/cgroup")


def available() -> float:
    """Bytes this process may use in all: the least limit of machine, control groups and process.

    Infinite if the system does not report any.
    """
    return min(_of_machine(), _of_control_groups(), _of_address_space())


def require(needed: float, what: str, remedy: str) -> None:
    """Raise `CaseError` if `what` needs more memory in all (`needed`, bytes) than is available."""
    there = available()
    if needed > there:
        raise CaseError(
            f"{what} take about {in_words(needed)} of memory, and {in_words(there)} are there; "
            f"{remedy}"
        )


def in_words(size: float) -> str:
    """A number of bytes in words, for messages."""
    return f"{size / 1e9:.3g} GB" if size >= 1e9 else f"{size / 1e6:.0f} MB"


def _of_machine() -> float:
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return math.inf


def _of_control_groups(groups: str = "/proc/self/cgroup") -> float:
    """The least limit of the control groups of this process and of their parents."""
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
        # In a container the path may be that of the host and not exist, but its root does.
        for folder in (group, *group.parents):
            least = min(least, _limit(folder / file))
            if folder == root:
                break
    return least


def _limit(file: Path) -> float:
    try:
        limit = float(file.read_text(encoding="ascii"))
    except (OSError, ValueError):  # no limit, or "max"
        return math.inf
    return limit if limit < 2**63 - _PAGE else math.inf


def _of_address_space() -> float:
    """The limit of `ulimit -v`, less addresses that are reserved but not resident."""
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
