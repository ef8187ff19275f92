"""Cache of operators and kernels: limited in size and safe to use from several threads."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable
from threading import RLock
from typing import Any, Protocol


class HasBytes(Protocol):
    """An object that reports its size, such as an array or an operator."""

    @property
    def nbytes(self) -> int:
        """Size of the arrays of this object (bytes)."""


class OperatorCache:
    """The most recently used values, at most `max_items` with at most `max_bytes` in total.

    There may be more while they have at most `small_bytes` in total. Values are shared between
    threads, so callers must not change them.
    """

    def __init__(self, max_bytes: int, max_items: int, small_bytes: int = 0) -> None:
        self._max_bytes, self._max_items, self._small_bytes = max_bytes, max_items, small_bytes
        self._values: OrderedDict[Hashable, HasBytes] = OrderedDict()
        self._nbytes = 0
        self._lock = RLock()

    @property
    def max_bytes(self) -> int:
        """Largest total size of all values (bytes). Setting a lower limit drops values."""
        return self._max_bytes

    @max_bytes.setter
    def max_bytes(self, limit: int) -> None:
        """Largest total size of all values (bytes). Setting a lower limit drops values."""
        with self._lock:
            self._max_bytes = limit
            self._shrink()

    @property
    def nbytes(self) -> int:
        """Total size of all values (bytes)."""
        return self._nbytes

    def __len__(self) -> int:
        return len(self._values)

    def get(self, key: Hashable) -> Any:
        """Return the value for `key`, or None."""
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
            return self._values.get(key)

    def put(self, key: Hashable, value: HasBytes) -> None:
        """Store `value`, unless it alone exceeds `max_bytes`."""
        with self._lock:
            if value.nbytes <= self._max_bytes:
                former = self._values.pop(key, None)
                self._nbytes += value.nbytes - (former.nbytes if former is not None else 0)
                self._values[key] = value
                self._shrink()

    def clear(self) -> None:
        """Drop all values. A running solve keeps the values that it uses."""
        with self._lock:
            self._values.clear()
            self._nbytes = 0

    def _shrink(self) -> None:
        def is_full() -> bool:
            many = len(self) > self._max_items and self._nbytes > self._small_bytes
            return many or self._nbytes > self._max_bytes

        while self._values and is_full():
            self._nbytes -= self._values.popitem(last=False)[1].nbytes


# Cache of operators and kernels for the whole process. Each operator fits one size of the rectangle
# of nodes that is solved, which grows with the contact. Other surfaces need the same sizes again.
operator_cache = OperatorCache(max_bytes=384 * 2**20, max_items=17, small_bytes=16 * 2**20)
