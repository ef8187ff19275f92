"""Read-only arrays."""

import numpy as np

from restitution.numerics.read_only import freeze, read_only


def test_an_array_that_its_owner_can_write_to_is_copied():
    mine = np.arange(6.0)
    held = read_only(mine)
    mine[0] = 7.0
    assert mine.flags.writeable
    assert not held.flags.writeable
    assert held[0] == 0.0


def test_a_read_only_view_of_a_writeable_array_is_copied():
    mine = np.arange(6.0)
    held = read_only(freeze(mine[::2]))
    mine[0] = 7.0
    assert held[0] == 0.0


def test_an_array_that_nobody_can_write_to_is_taken_as_it_is():
    frozen = freeze(np.arange(6.0))
    assert read_only(frozen) is frozen
    part = frozen[1:]
    assert read_only(part) is part


def test_memory_that_is_not_of_an_array_is_copied():
    memory = bytearray(8)
    held = read_only(freeze(np.frombuffer(memory, dtype=np.uint8)))
    memory[0] = 7
    assert held[0] == 0
