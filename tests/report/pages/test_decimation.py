import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from space_robot_report.pages.plots import min_max

signals = hnp.arrays(np.float64, st.integers(1, 5000), elements=st.floats(-1e9, 1e9))


@settings(deadline=None, max_examples=50)
@given(values=signals, buckets=st.integers(1, 60))
def test_decimation_keeps_first_last_smallest_and_largest(values, buckets):
    """First, last, smallest and largest value stay, in order, and the number of points is bounded."""
    kept = min_max(values, buckets)
    assert (np.diff(kept) > 0).all()
    assert {0, values.size - 1} <= set(kept.tolist())
    assert values[kept].max() == values.max()
    assert values[kept].min() == values.min()
    assert kept.size <= max(2 * buckets + 2, 1)


def test_a_single_spike_between_quiet_stretches_stays():
    """One sample in a hundred thousand that is off is still there afterwards."""
    values = np.zeros(100_000)
    values[54_321] = -7.0
    assert 54_321 in min_max(values)


def test_short_signals_are_left_alone():
    """A signal with few points keeps every one of them."""
    assert min_max(np.arange(90.0), 45).tolist() == list(range(90))
