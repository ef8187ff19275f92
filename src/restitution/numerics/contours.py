"""Nested contours of an array, from its peaks down to zero."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[Any]  # double precision


@use_loop
def contour_means(values: Array, periodic: bool, out: Array) -> None:
    """Write the mean of S/n^1.5 over the contours around each node into `out`; 0 where v ≤ 0.

    Between two saddles, the contours around a node belong to one part of the array. S = Σ v is the
    sum over its catchment, and n = S exp(−Σ v ln v/S) the number of nodes there, without those of
    small v: the exponential of an entropy. The mean is over the levels from 0 to v.
    """
    rows, columns = values.shape
    flat = values.ravel()
    order = np.argsort(-flat, kind="stable")[: int(np.count_nonzero(flat > 0))]
    home, peak = np.full(flat.size, -1), np.full(flat.size, -1)
    inside: list[int] = []
    into: list[int] = []
    end: list[float] = []
    total: list[float] = []
    logs: list[float] = []

    def now(part: int) -> int:
        while inside[part] != part:
            inside[part] = inside[inside[part]]
            part = inside[part]
        return part

    for node in order.tolist():
        value, others = float(flat[node]), []
        i, j = divmod(node, columns)
        for other in _around(i, j, rows, columns, periodic):
            if home[other] >= 0:
                others.append(other)
        old = {now(int(home[other])) for other in others}
        if len(old) == 1:
            (part,) = old
        else:
            part = len(inside)
            inside.append(part)
            into.append(-1)
            for new in (end, total, logs):
                new.append(0.0)
            for merged in old:
                inside[merged] = into[merged] = part
                end[merged] = value
        home[node] = part
        peak[node] = peak[max(others, key=flat.__getitem__)] if others else part
        total[peak[node]] += value
        logs[peak[node]] += value * float(np.log(value))
    for part, whole in enumerate(into):
        if whole >= 0:
            total[whole] += total[part]
            logs[whole] += logs[part]
    sums = np.array(total)
    own, below = np.exp(1.5 * np.array(logs) / sums) / np.sqrt(sums), np.zeros(len(into))

    def mean(part: int, level: float) -> float:
        below_it = below[part] if into[part] >= 0 else own[part]
        return float(own[part] + end[part] / level * (below_it - own[part]))

    for part in reversed(range(len(into))):
        if into[part] >= 0:
            below[part] = mean(into[part], end[part])
    out[...] = 0
    for node in order.tolist():
        out[divmod(node, columns)] = mean(int(home[node]), float(flat[node]))


def _around(i: int, j: int, rows: int, columns: int, periodic: bool) -> list[int]:
    steps = ((i - 1, j), (i, j - 1), (i, j + 1), (i + 1, j))
    if periodic:
        return [(k % rows) * columns + m % columns for k, m in steps]
    return [k * columns + m for k, m in steps if 0 <= k < rows and 0 <= m < columns]
