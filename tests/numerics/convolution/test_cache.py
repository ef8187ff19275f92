"""The cache of operators: its limits, and its use by several threads."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from restitution.numerics.convolution.cache import OperatorCache, operator_cache


def block(size):
    return np.zeros(size, np.uint8)


@pytest.fixture
def cache():
    return OperatorCache(max_bytes=100, max_items=3)


def test_a_value_is_found_until_all_are_dropped(cache):
    value = block(10)
    cache.put("a", value)
    assert cache.get("a") is value
    assert cache.get("b") is None
    assert (len(cache), cache.nbytes) == (1, 10)
    cache.clear()
    assert cache.get("a") is None
    assert (len(cache), cache.nbytes) == (0, 0)


def test_the_least_recently_used_is_dropped_first(cache):
    for key in "abc":
        cache.put(key, block(30))
    cache.get("a")
    cache.put("d", block(30))
    assert [key for key in "abcd" if cache.get(key) is not None] == ["a", "c", "d"]
    cache.put("e", block(60))  # several entries are dropped if necessary
    assert [key for key in "abcde" if cache.get(key) is not None] == ["d", "e"]


def test_more_small_values_are_kept():
    cache = OperatorCache(max_bytes=100, max_items=3, small_bytes=50)
    for key in "abcde":
        cache.put(key, block(10))
    assert (len(cache), cache.nbytes) == (5, 50)
    cache.put("f", block(20))  # as many as take no more than 50 bytes
    assert [key for key in "abcdef" if cache.get(key) is not None] == ["c", "d", "e", "f"]
    cache.put("g", block(60))
    assert [key for key in "cdefg" if cache.get(key) is not None] == ["e", "f", "g"]


def test_a_value_takes_the_place_of_the_former_one(cache):
    cache.put("a", block(60))
    cache.put("a", block(80))
    assert (len(cache), cache.nbytes) == (1, 80)


def test_what_is_larger_than_the_cache_is_not_kept_and_drops_nothing(cache):
    cache.put("a", block(60))
    cache.put("b", block(101))
    assert cache.get("b") is None
    assert cache.nbytes == 60


def test_a_smaller_limit_holds_at_once(cache):
    cache.put("a", block(30))
    cache.put("b", block(30))
    cache.max_bytes = 40
    assert (cache.max_bytes, cache.nbytes) == (40, 30)
    assert cache.get("a") is None
    cache.max_bytes = 0
    assert len(cache) == 0


def test_threads_leave_it_within_its_limits(cache):
    def work(seed):
        rng = np.random.default_rng(seed)
        for key in rng.integers(0, 6, 400):
            value = cache.get(key)
            assert value is None or value.nbytes == 10 * (key + 1)
            cache.put(key, block(10 * (key + 1)))
            assert cache.nbytes <= 100
            if key == 0:
                cache.clear()

    with ThreadPoolExecutor(8) as threads:
        list(threads.map(work, range(8)))
    assert len(cache) <= 3


def test_the_size_of_the_cache_of_the_package():
    assert operator_cache.max_bytes == 384 * 2**20
