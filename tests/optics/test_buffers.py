"""Large arrays over memory that was used before, never over memory that is in use."""

import numpy as np
import pytest

import lensbench as lb
from lensbench.optics import buffers, surfaces

SIZE = buffers.LEAST + 1


@pytest.fixture(autouse=True)
def nothing_spare(monkeypatch):
    monkeypatch.setattr(buffers, "_spare", type(buffers._spare)(maxlen=4))


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
    assert len(buffers._spare) == 4
    assert buffers.uninitialised(SIZE + 9).size == SIZE + 9


def test_no_more_is_kept_than_the_largest_array(monkeypatch):
    monkeypatch.setattr(buffers, "MOST", 3 * SIZE)
    arrays = [buffers.uninitialised(2 * SIZE) for _ in range(2)]
    places = [address(array) for array in arrays]
    del arrays[0]
    del arrays[0]
    assert [address(spare) for spare in buffers._spare] == places[1:]


@pytest.mark.parametrize("n", [256, 1024])
def test_a_trace_is_written_over_the_memory_of_the_one_before(lens_of, n):
    """Of several chunks of rays, up to 1024 x 1024 gazes: pages new from the system cost as much as the kernels."""
    lens, grid = lens_of(surfaces.sphere(95.0), surfaces.sphere(110.0)), lb.GazeGrid(n, n)
    field = lb.trace(lens, lb.Wearer(), grid)
    del field
    largest = max(buffers._spare, key=len)
    assert largest.size >= 28 * n * n
    field = lb.trace(lens, lb.Wearer(), grid)
    assert np.shares_memory(field.transfer, largest)


@pytest.mark.parametrize("size", [0, 10, buffers.MOST + 1])
def test_small_and_huge_arrays_are_new(size):
    array = buffers.uninitialised(size)
    assert array.size == size
    del array
    assert not buffers._spare
