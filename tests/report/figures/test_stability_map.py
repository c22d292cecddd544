"""The stability map as it is drawn: regions where the loop is stable, marks where the shipped settings are."""

from __future__ import annotations

import matplotlib.pyplot as plt
import pytest

from space_robot_control.laws.mfac.stability import spectral_radius
from space_robot_msgs_py.errors import SpecError
from space_robot_report.figures.stability_map import draw_stability
from space_robot_studies.reproduce.stability_map import StabilityMap


def test_a_drawn_region_is_where_the_loop_is_stable() -> None:
    """The filled area of a held command holds exactly the stable points, well away from its border."""
    figure, axis = plt.subplots()
    try:
        wanted = StabilityMap(label="y", ratio=(1e-2, 1e2), rho=(1e-3, 1.0), points=40)
        draw_stability(axis, wanted)
        region = axis.collections[0].get_paths()
        for ratio, rho in ((0.5, 0.02), (0.5, 0.9), (5.0, 0.01), (0.1, 0.005)):
            inside = any(path.contains_point((ratio, rho)) for path in region)
            assert inside == (spectral_radius(ratio, rho) < 1.0), (ratio, rho)
    finally:
        plt.close(figure)


def test_a_range_that_does_not_rise_is_refused() -> None:
    """A range that does not rise is no map."""
    with pytest.raises(SpecError, match="ratio is"):
        StabilityMap(label="y", ratio=(1.0, 0.1))
