"""The cache of operators and kernels: limited in size, shared by threads, emptied by `clear`."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable
from threading import Lock
from typing import Any, Protocol


class HasBytes(Protocol):
    """Something that knows its size, as arrays and operators do."""

    @property
    def nbytes(self) -> int:
        """Size of its arrays, bytes."""


class OperatorCache:
    """Values by key, at most `max_items` of them and `max_bytes` in all.

    The least recently used values are dropped first. All methods are safe in threads. Values are
    shared, so callers must not change them.
    """

    def __init__(self, max_bytes: int, max_items: int) -> None:
        self._max_bytes, self._max_items = max_bytes, max_items
        self._values: OrderedDict[Hashable, HasBytes] = OrderedDict()
        self._lock = Lock()

    @property
    def max_bytes(self) -> int:
        """Largest size of all values together, bytes. Setting it drops what no longer fits."""
        return self._max_bytes

    @max_bytes.setter
    def max_bytes(self, limit: int) -> None:
        with self._lock:
            self._max_bytes = limit
            self._shrink()

    @property
    def nbytes(self) -> int:
        """Size of all values together, bytes."""
        with self._lock:
            return self._size()

    def __len__(self) -> int:
        return len(self._values)

    def get(self, key: Hashable) -> Any:
        """The value of `key`, or None."""
        with self._lock:
            if key not in self._values:
                return None
            self._values.move_to_end(key)
            return self._values[key]

    def put(self, key: Hashable, value: HasBytes) -> None:
        """Keep `value`, unless it is larger than the whole cache may be."""
        with self._lock:
            if value.nbytes > self._max_bytes:
                return
            self._values[key] = value
            self._values.move_to_end(key)
            self._shrink()

    def clear(self) -> None:
        """Drop all values. Solves that use one of them are not disturbed."""
        with self._lock:
            self._values.clear()

    def _size(self) -> int:
        return sum(value.nbytes for value in self._values.values())

    def _shrink(self) -> None:
        while self._values and (
            len(self._values) > self._max_items or self._size() > self._max_bytes
        ):
            self._values.popitem(last=False)


# Boxes follow the contact, so that older operators are rarely used again.
operator_cache = OperatorCache(max_bytes=384 * 2**20, max_items=17)
