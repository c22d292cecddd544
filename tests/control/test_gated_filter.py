"""The filter of sampled errors: its poles are those of the bandwidth that was given."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.gated_filter import GatedFilter


@pytest.mark.parametrize(("period", "bandwidth"), [(0.1, 3.0), (0.5, 1.0), (0.25, 8.0)])
def test_both_poles_are_where_the_bandwidth_says(period: float, bandwidth: float) -> None:
    """What is left of an error follows e'' - 2 p e' + p^2 e = 0, tick by tick, with p = exp(-bandwidth T)."""
    found = GatedFilter(period, bandwidth, np.array([np.inf]), 5)
    found.update(np.array([1.0]))
    left = [found.value.item()]
    for _ in range(20):
        found.update(np.array([0.0]))
        left.append(found.value.item())
    pole = np.exp(-bandwidth * period)
    assert left[0] == 1.0
    assert left[1] == pytest.approx(pole**2)
    np.testing.assert_allclose(left[2:], 2 * pole * np.array(left[1:-1]) - pole**2 * np.array(left[:-2]), atol=1e-14)


def test_each_channel_has_its_sample_or_its_prediction() -> None:
    """A refused sample of one channel leaves what was predicted of it; the other channel takes its own."""
    found = GatedFilter(0.5, 1.0, np.array([0.5, 2.0]), 2)
    assert found.missing.tolist() == [False, False]
    assert found.missing.dtype == bool
    for k in range(60):
        found.update(np.array([0.25 * k, -0.5 * k]))
    predicted = found.value + 0.5 * found.rate
    np.testing.assert_allclose(found.rate, [0.5, -1.0], atol=1e-6)
    found.update(predicted + 1.0)
    assert found.missing.tolist() == [True, False]
    assert found.refused.tolist() == [1.0, 0.0]
    np.testing.assert_allclose(found.value[0], predicted[0], atol=1e-12)


def test_a_channel_that_begins_again_has_no_rate_and_the_others_keep_theirs() -> None:
    """After so many refusals in a row its next sample is taken as it is."""
    found = GatedFilter(0.5, 1.0, np.array([0.5, 0.5]), 2)
    for k in range(60):
        found.update(np.array([0.25 * k, 0.25 * k]))
    for k in range(60, 63):
        found.update(np.array([99.0, 0.25 * k]))
    assert (found.value[0], found.rate[0]) == (99.0, 0.0)
    np.testing.assert_allclose([found.value[1], found.rate[1]], [0.25 * 62, 0.5], atol=1e-6)
    assert found.refused.tolist() == [2.0, 0.0]


@pytest.mark.parametrize(("jump", "missing"), [(0.5, False), (0.5 + 1e-12, True)])
def test_a_sample_on_the_gate_passes(jump: float, missing: bool) -> None:
    """The gate is the largest distance that is credible."""
    found = GatedFilter(0.5, 1.0, np.array([0.5]), 2)
    found.update(np.array([0.0]))
    found.update(np.array([jump]))
    assert found.missing.item() is missing
