"""Memory available to this process, and the check before a large allocation."""

from __future__ import annotations

import math
import os
from pathlib import Path

from restitution.errors import CaseError

# Size of a memory page (bytes). If there is no limit, control groups of version 1 report
# 2**63 − 1, rounded down to whole pages.
_PAGE = 2**12
_GROUPS = Path("/sys/fs/cgroup")


def available() -> float:
    """Most memory that this process can use (bytes); infinite if the system reports no limit."""
    return min(_of_machine(), _of_control_groups(), _of_address_space())


def require(needed: float, what: str, remedy: str) -> None:
    """Raise `CaseError` if `what` needs more memory (`needed`, bytes) than is available."""
    if needed > (there := available()):
        raise CaseError(
            f"{what} take about {in_words(needed)} of memory, but only {in_words(there)} is "
            f"available; {remedy}"
        )


def in_words(size: float) -> str:
    """Format a number of bytes for messages."""
    return f"{size / 1e9:.3g} GB" if size >= 1e9 else f"{size / 1e6:.0f} MB"


def _of_machine() -> float:
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return math.inf


def _of_control_groups(groups: str = "/proc/self/cgroup") -> float:
    least = math.inf
    try:
        lines = Path(groups).read_text(encoding="utf-8").splitlines()
    except OSError:
        return least
    for line in lines:
        # Lines for control groups of version 2 have an empty second field. Lines for version 1 have
        # a list of controllers in this field.
        match line.split(":", 2):
            case [_, "", path]:
                root, file = _GROUPS, "memory.max"
            case [_, controllers, path] if "memory" in controllers.split(","):
                root, file = _GROUPS / "memory", "memory.limit_in_bytes"
            case _:
                continue
        group = root / path.lstrip("/")
        # In a container, `path` can be a path on the host. Then `group` does not exist here, and
        # the limit is read from a parent folder, at the latest from `root`.
        folders = [path for path in (group, *group.parents) if path.is_relative_to(root)]
        least = min(least, *(_limit(folder / file) for folder in folders))
    return least


def _limit(file: Path) -> float:
    try:
        limit = float(file.read_text(encoding="ascii"))
    except (OSError, ValueError):  # no such file, or "max" (no limit)
        return math.inf
    return limit if limit < 2**63 - _PAGE else math.inf


def _of_address_space() -> float:
    """Memory (bytes) that the limit on the address space (`ulimit -v`) allows.

    Address ranges that are reserved but occupy no memory count against this limit.
    """
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
