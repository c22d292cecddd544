"""Plots of a log show what its ticks say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("plotly")

from space_robot_description.rotations import from_rpy
from space_robot_msgs_py.log.arrays import arrays_of
from space_robot_report.block_names import block_names
from space_robot_report.pages.log_plots import motion_plots
from space_robot_report.pages.telemetry import check_units, constants, varying
from tests.support import values


def test_turns_are_counted_only_where_every_tick_is_there() -> None:
    """At 100 deg a tick a robot turns on in the plot of a whole log, and stays within a turn in a thinned one."""
    arrays = arrays_of(values.run_ticks(30))
    q = np.array(arrays.q)
    q[:, 3:7] = [from_rpy([0.0, 0.0, np.radians(100.0 * k)]) for k in range(30)]
    arrays = replace(arrays, q=q, plant={})
    for whole, largest in ((True, 2900.0), (False, 180.0)):
        plot = next(motion_plots(arrays, values.NAMES, None, whole=whole))
        yaw = next(trace for trace in plot.traces if trace.name == "yaw")
        assert largest - 90.0 < np.abs(yaw.values).max() < largest + 1e-6
        np.testing.assert_allclose(np.cos(np.radians(yaw.values)), np.cos(np.radians(100.0 * np.arange(30))), atol=1e-9)


def test_numbers_of_a_block_have_names() -> None:
    """As many as joints: of the joints; three: of the axes; a size that may mean two things, or nothing, is counted."""
    joints = ("shoulder", "elbow")
    assert block_names(2, joints) == joints
    assert block_names(3, joints) == ("x", "y", "z")
    assert block_names(8, joints)[5:] == ("about z", *joints)
    assert block_names(9, joints)[6:] == ("qw", *joints)
    assert block_names(3, ("a", "b", "c")) == ("[0]", "[1]", "[2]")
    assert block_names(5, joints) == ("[0]", "[1]", "[2]", "[3]", "[4]")
    assert block_names(1, joints) == ("",)


def test_what_does_not_change_is_folded() -> None:
    """Once as a line of numbers, and not as a plot; each block is in one of the two."""
    blocks = {"still": np.full((5, 2), 0.5), "moves": np.arange(5.0).reshape(5, 1), "many": np.ones((5, 40))}
    assert constants(blocks) == [("still", "0.5, 0.5"), ("many", f"{', '.join(['1'] * 12)}, ...")]
    assert list(varying(blocks)) == ["moves"]


def test_metrics_have_units() -> None:
    """Those of a run without axes, too."""
    assert check_units(None) == {"effort_integral": "N m s", "joint_limit": "rad or m", "integration_error": "rad or m"}
