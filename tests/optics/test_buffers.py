"""Large arrays over memory that was used before, never over memory that is in use."""

import numpy as np
import pytest

from lensbench.optics import buffers

SIZE = buffers.LEAST + 1


@pytest.fixture(autouse=True)
def nothing_spare(monkeypatch):
    monkeypatch.setattr(buffers, "_spare", type(buffers._spare)(maxlen=2))


def address(array):
    return array.__array_interface__["data"][0]


def test_memory_that_nobody_refers_to_is_used_again():
    first = buffers.uninitialised(SIZE)
    place = address(first)
    assert first.shape == (SIZE,)
    assert first.flags.writeable
    del first
    assert address(buffers.uninitialised(SIZE)) == place


def test_a_view_keeps_its_memory():
    first = buffers.uninitialised(SIZE)
    first[:] = 1.0
    view = first.reshape(-1, 1)[3:5, 0].T
    del first
    second = buffers.uninitialised(SIZE)
    second[:] = 2.0
    assert np.array_equal(view, [1.0, 1.0])


def test_only_arrays_of_the_same_size_share_memory_and_few_are_kept():
    places = {address(array) for array in [buffers.uninitialised(SIZE + k) for k in range(5)]}
    assert len(places) == 5
    assert len(buffers._spare) == 2
    assert buffers.uninitialised(SIZE + 9).size == SIZE + 9


@pytest.mark.parametrize("size", [0, 10, buffers.MOST + 1])
def test_small_and_huge_arrays_are_new(size):
    array = buffers.uninitialised(size)
    assert array.size == size
    del array
    assert not buffers._spare
