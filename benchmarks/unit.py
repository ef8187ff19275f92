"""The unit U of the times, and a description of the machine on which they were measured."""

from __future__ import annotations

import datetime
import os
import platform
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy.fft


def convolution(n: int) -> None:
    """Compute one U: a zero-padded convolution, forward and inverse, on n × n nodes in float64."""
    p = np.ones((n, n))
    modes = scipy.fft.rfft2(p, s=(2 * n, 2 * n), workers=2)
    modes *= 1.0
    scipy.fft.irfft2(modes, s=(2 * n, 2 * n), workers=2)


def seconds(work: Callable[[], object]) -> float:
    """Wall time of a call."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def measure_unit(n: int, *, samples: int = 5) -> float:
    """U on n × n nodes in seconds: the median after one call that is not counted."""
    convolution(n)
    return statistics.median(seconds(lambda: convolution(n)) for _ in range(samples))


def machine() -> str:
    """Processor, number of cores and load average; times are reliable only at a low load."""
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        models = [
            line.partition(":")[2]
            for line in cpuinfo.read_text().splitlines()
            if line.startswith("model name")
        ]
        model = models[0].strip() if models else model
    return f"{model}, {os.cpu_count()} cores, load average {os.getloadavg()[0]:.1f} at the start"


def today() -> str:
    """The date, as 2026-01-31."""
    return datetime.date.today().isoformat()
