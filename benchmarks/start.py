"""Time to import the package and to print its help, relative to numpy and scipy.fft.

Writes benchmarks/start.md. The processes take turns; times are those of whole processes.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
from pathlib import Path

from unit import machine, seconds, today

OUT = Path(__file__).with_suffix(".md")
TURNS = 15
BASE = "numpy and scipy.fft"
COMMANDS = {
    BASE: ["-c", "import numpy, scipy.fft"],
    "`import restitution`": ["-c", "import restitution"],
    "`import restitution`, and the solver": ["-c", "from restitution import Contact, solve"],
    "`restitution --help`": ["-m", "restitution", "--help"],
}

REPORT = """\
# Time to start

{date}, {machine}. Written by `make bench`.

The table shows the time of whole Python processes: the median of {turns} runs (smallest and
largest). The processes ran in turn. The times include the start of Python itself, which takes
{bare:.3f} s without any import.

| process | time, s | ratio to {base} |
|---|---|---|
{rows}
"""


def start(arguments: list[str]) -> float:
    """Time (s) of a Python process with `arguments`."""
    return seconds(
        lambda: subprocess.run([sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL)
    )


def main() -> None:
    """Time the commands and write the report."""
    where = machine()
    times: dict[str, list[float]] = {name: [] for name in COMMANDS}
    for arguments in COMMANDS.values():
        start(arguments)
    for _ in range(TURNS):
        for name, arguments in COMMANDS.items():
            times[name].append(start(arguments))
    bare = statistics.median(start(["-c", ""]) for _ in range(TURNS))
    base = statistics.median(times[BASE])
    rows = "\n".join(
        f"| {name} | {statistics.median(its):.3f} ({min(its):.3f} to {max(its):.3f}) | "
        f"{statistics.median(its) / base:.2f} |"
        for name, its in times.items()
    )
    report = REPORT.format(
        date=today(), machine=where, turns=TURNS, bare=bare, base=BASE, rows=rows
    )
    OUT.write_text(report)
    print(report)


if __name__ == "__main__":
    main()
