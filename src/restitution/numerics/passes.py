"""What the solver does at the nodes but for its transforms, several steps at a time.

Each function is written here as an expression of whole arrays, which holds for batches and on any
device (`device`). For one problem on this machine the loop of the same name in `loops` does the
same in one pass over memory; the tests hold one to the other. The bounds `lower` and `upper` are
numbers or arrays that go with p.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

from restitution.numerics import items
from restitution.numerics.items import Flag, Number, anywhere, largest
from restitution.numerics.kernels import loops

Array = NDArray[Any]  # of double or single precision
Bound = NDArray[np.float64] | float
Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def _by_loop(expression: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Let the loop of that name do what the expression would, where the first array is plain."""
    loop = getattr(loops, expression.__name__, None)
    if loop is None:
        return expression

    @wraps(expression)
    def either(*args: Any) -> Any:
        if not _is_plain(args[0]):
            return expression(*args)  # type: ignore[call-arg]
        found = loop(*args)
        return tuple(map(_number, found)) if isinstance(found, tuple) else _number(found)

    return either  # type: ignore[return-value]


def _is_plain(values: Any) -> bool:
    """Whether these are values of one problem, on this machine, and each row in one piece."""
    if type(values) is not np.ndarray or values.ndim != 2:
        return False
    return values.strides[1] == values.itemsize or values.shape[1] < 2


def _number(found: Any) -> Any:
    """What a loop returns as a number of `items`."""
    if found is None:
        return None
    return np.bool_(found) if isinstance(found, bool) else np.float64(found)


def as_rows(bound: Bound, p: Array) -> Bound:
    """The bound as loops take it: a number as an array like p whose rows are all the same one."""
    if loops is None or not _is_plain(p) or isinstance(bound, np.ndarray):
        return bound
    return np.broadcast_to(np.full(p.shape[1], bound), p.shape)


@_by_loop
def downhill(p: Array, g: Array, b: Array, lower: Bound, upper: Bound, out: Array) -> Number:
    """Turn K p, in `g`, into the gradient K p − b; its largest value where p may follow it down.

    Going down means within the bounds. `out` is the gradient there, else zero.
    """
    g -= b
    slope = g * _free(p, g, lower, upper)
    out[...] = slope
    return largest(slope)


@_by_loop
def levels(r: Array, sums: Array, nodes: Array) -> None:
    """Σ r, and at how many nodes it is not zero, around places all over, in `sums` and `nodes`.

    Both are of shape (*batch, places, places); between the middles of two places a node counts to
    either of them, linearly.
    """
    over_x, over_y = _hats(r, sums)
    sums[...] = over_x.T @ r @ over_y
    nodes[...] = over_x.T @ (r != 0).astype(np.float64) @ over_y


@_by_loop
def lower(r: Array, share: Number, sums: Array, nodes: Array, out: Array) -> None:
    """r less `share` of its mean around each node, where it is not zero, else zero, in `out`."""
    over_x, over_y = _hats(r, sums)
    total, count = (over_x @ at_places @ over_y.T for at_places in (sums, nodes))
    np.multiply(r - share * total / (count + (r == 0)), r != 0, out=out)


@_by_loop
def products(z: Array, r: Array, r_old: Array) -> tuple[Number, Number]:
    """r·z and r_old·z."""
    return items.dot(r, z), items.dot(r_old, z)


@_by_loop
def curvature(d: Array, Kd: Array) -> tuple[Number, Number]:
    """d·Kd and the largest magnitude of Kd."""
    return items.dot(d, Kd), largest(Kd)


@_by_loop
def direct(
    d: Array,
    kept: Number,
    z: Array,
    length: Number,
    p: Array,
    g: Array,
    r: Array,
    lower: Bound,
    upper: Bound,
) -> tuple[Number, Flag]:
    """Turn the step d at p to `kept` d − `length` z on the free nodes, and end it at the bounds.

    Returns r·d and whether some of it was cut off.
    """
    d *= kept
    d -= length * z
    d *= _free(p, g, lower, upper)
    end = p + d
    cut = _outside(end, lower, upper)
    np.clip(end, lower, upper, out=end)
    np.subtract(end, p, out=d)
    return items.dot(r, d), cut


@_by_loop
def leaves(p: Array, d: Array, taken: Number, lower: Bound, upper: Bound) -> Flag:
    """Whether p + `taken` d lies outside the bounds somewhere."""
    return _outside(p + taken * d, lower, upper)


@_by_loop
def advance(
    p: Array, g: Array, d: Array, Kd: Array, taken: Number, lower: Bound, upper: Bound, out: Array
) -> Number:
    """Go to p + `taken` d, where the gradient is g + `taken` Kd; `out` and result as of `downhill`.

    A step that ended at a bound, and is taken whole, gets there without a rounding.
    """
    low, high = (
        (taken == 1) & (d == (bound - p).astype(d.dtype, copy=False)) for bound in (lower, upper)
    )
    p += taken * d
    np.clip(p, np.where(high, upper, lower), np.where(low, lower, upper), out=p)
    g += taken * Kd
    np.multiply(g, _free(p, g, lower, upper), out=out)
    return largest(out)


@_by_loop
def peak(values: Array) -> Number:
    """The largest magnitude."""
    return largest(values)


@_by_loop
def coarsen(fine: Array, coarse: Array) -> None:
    """Means over 2 × 2 nodes, in `coarse`; a last odd row or column counts twice."""
    rows, columns = (n % 2 for n in fine.shape[-2:])
    fine = np.pad(fine, [(0, 0)] * (fine.ndim - 2) + [(0, rows), (0, columns)], mode="edge")
    np.add(fine[..., ::2, ::2], fine[..., 1::2, ::2], out=coarse)
    coarse += fine[..., ::2, 1::2]
    coarse += fine[..., 1::2, 1::2]
    coarse *= 0.25


@_by_loop
def refine(coarse: Array, fine: Array) -> None:
    """Linear interpolation of what `coarsen` makes, in `fine`; constant at the ends."""
    rows, columns = fine.shape[-2:]
    taller = _refined(coarse)[..., :rows, :].swapaxes(-1, -2)
    fine[...] = _refined(taller)[..., :columns, :].swapaxes(-1, -2)


@_by_loop
def multipoles(x: Array, y: Array, moments: Array, out: Array) -> None:
    """Σ_kl moments[k, l] c^l / r^(2k + 1) at (x, y), a column and a row, in `out`.

    c = x²/r² is the squared direction cosine along x; `moments` are of shape (3, 3).
    """
    s = 1.0 / (x * x + y * y)
    c = x * x * s
    out[...] = 0.0
    for row in moments[::-1]:
        out *= s
        out += (row[2] * c + row[1]) * c + row[0]
    out *= np.sqrt(s)


@_by_loop
def spread(neighbours: NDArray[np.intp], weights: Array, steps: int, sums: Array) -> None:
    """Replace two sums at each node, `steps` times, by those of its neighbours, weighted.

    `neighbours` and `weights` are of shape (nodes, neighbours), `sums` of (nodes, 2).
    """
    for _ in range(steps):
        sums[...] = np.einsum("ij,ijk->ik", weights, sums[neighbours])


def _hats(r: Array, places: Array) -> list[Array]:
    """How much each row, and each column, of `r` counts to each of the places."""
    hats = []
    for n, m in zip(r.shape[-2:], places.shape[-2:], strict=True):
        node, place = (np.cumsum(np.ones_like(places, shape=k)) for k in (n, m))
        middle = np.clip((node - 0.5) * m / n + 0.5, 1, m)
        hats.append(np.maximum(0.0, 1.0 - np.abs(middle[:, None] - place)))
    return hats


def _refined(coarse: Array) -> Array:
    """Linear interpolation from rows twice as wide; constant at the ends."""
    before = np.concatenate([coarse[..., :1, :], coarse[..., :-1, :]], axis=-2)
    after = np.concatenate([coarse[..., 1:, :], coarse[..., -1:, :]], axis=-2)
    *batch, n, columns = coarse.shape
    fine = np.empty_like(coarse, shape=(*batch, 2 * n, columns), order="C")
    fine[..., ::2, :] = 0.75 * coarse + 0.25 * before
    fine[..., 1::2, :] = 0.75 * coarse + 0.25 * after
    return fine


def _free(p: Array, g: Array, lower: Bound, upper: Bound) -> NDArray[np.bool_]:
    """Nodes that may go downhill: between the bounds, or on one and pushed off it."""
    free = p > lower
    free |= g < 0
    if _is_absent(upper):
        return free
    below = p < upper
    below |= g > 0
    free &= below
    return free


def _outside(p: Array, lower: Bound, upper: Bound) -> Flag:
    """Whether each item leaves its bounds somewhere."""
    outside = p < lower
    if not _is_absent(upper):
        outside |= p > upper
    return anywhere(outside)


def _is_absent(upper: Bound) -> bool:
    """Whether there is no upper bound, so that nothing needs to be compared with it."""
    return isinstance(upper, float) and upper == np.inf
