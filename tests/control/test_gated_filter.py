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
