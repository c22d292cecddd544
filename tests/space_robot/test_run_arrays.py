"""The arrays of a run: what they are, in tables and in pictures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest

import space_robot as sr


def arrays(value: Any) -> Iterator[np.ndarray[Any, Any]]:
    """Every array of a run's arrays."""
    if isinstance(value, np.ndarray):
        yield value
    parts = [getattr(value, one.name) for one in fields(value)] if is_dataclass(value) else []
    for part in value.values() if hasattr(value, "values") else parts:
        yield from arrays(part)


def test_the_arrays_are_those_of_the_log(run: sr.Run) -> None:
    """Each array is the part of the log's that its name says, in the order of the ticks."""
    log, named, last = run.log.arrays(), run.arrays, [*run.log.ticks()][-1]
    q, v = last.sample.state.q, last.sample.state.v
    pairs = [
        (named.time, log.stamp / 1e9),
        (np.hstack([named.base.position, named.base.quaternion, named.joints.position]), log.q),
        (np.hstack([named.base.linear_velocity, named.base.angular_velocity, named.joints.velocity]), log.v),
        (named.joints.effort, log.effort),
        (named.base.acceleration, log.base_acceleration),
        (np.hstack([named.command.force, named.command.torque]), log.wrench),
        (named.command.effort, log.effort_command),
        (named.base.quaternion[-1], q[3:7]),
        (named.joints.velocity[-1], v[6:]),
    ]
    desired, joints = named.reference.base, named.reference.joints
    pairs += [
        (np.hstack([desired.position, desired.quaternion, joints.position]), log.q_d),
        (np.hstack([desired.linear_velocity, desired.angular_velocity, joints.velocity]), log.v_d),
        (np.hstack([desired.linear_acceleration, desired.angular_acceleration, joints.acceleration]), log.a_d),
        (named.reference.joints.position[-1], last.reference.q[7:]),
    ]
    for mine, wanted in pairs:
        np.testing.assert_array_equal(mine, wanted)
    assert named.telemetry.controller.keys() == log.controller.keys()
    np.testing.assert_array_equal(named.telemetry.plant["true_configuration"], log.plant["true_configuration"])


def test_arrays_cannot_be_changed(run: sr.Run) -> None:
    """Every array is read-only, and so is every mapping of arrays; they are read from the log once."""
    found = list(arrays(run.arrays))
    assert len(found) > 20
    assert not any(array.flags.writeable for array in found)
    with pytest.raises(ValueError, match="read-only"):
        run.arrays.base.position[0, 0] = 1.0
    with pytest.raises(TypeError):
        run.arrays.telemetry.plant["true_configuration"] = np.zeros(1)  # type: ignore[index]
    with pytest.raises(AttributeError):
        run.arrays.time = np.zeros(1)  # type: ignore[misc]
    assert run.arrays is run.arrays


def test_a_table_has_every_number_once(run: sr.Run) -> None:
    """One row per tick, by time, and one column per number, under its name and with its bits."""
    pytest.importorskip("pandas")
    table = run.to_pandas()
    assert table.shape == (9, sum(array.shape[1] for array in arrays(run.arrays) if array.ndim == 2))
    assert table.columns.is_unique
    assert table.index.name == "time"
    named = {
        "base.position.x": run.arrays.base.position[:, 0],
        "base.quaternion.w": run.arrays.base.quaternion[:, 3],
        "joints.position.joint2": run.arrays.joints.position[:, 1],
        "reference.base.angular_acceleration.z": run.arrays.reference.base.angular_acceleration[:, 2],
        "reference.joints.velocity.joint4": run.arrays.reference.joints.velocity[:, 3],
        "command.torque.y": run.arrays.command.torque[:, 1],
        "command.effort.joint3": run.arrays.command.effort[:, 2],
        "telemetry.controller.joint_error.0": run.arrays.telemetry.controller["joint_error"][:, 0],
        "telemetry.plant.energy_residual": run.arrays.telemetry.plant["energy_residual"][:, 0],
    }
    for column, wanted in named.items():
        np.testing.assert_array_equal(table[column].to_numpy(), wanted)
    np.testing.assert_array_equal(table.index.to_numpy(), run.arrays.time)


def test_a_plot_shows_what_is_in_the_arrays(run: sr.Run) -> None:
    """Four panels over time: attitude, joints, torques, efforts; the joints are those of the run, in degrees."""
    pyplot = pytest.importorskip("matplotlib.pyplot")
    figure = run.plot()
    try:
        assert len(figure.axes) == 4
        names = [text.get_text() for text in figure.axes[1].get_legend().get_texts()]
        assert names == [*run.joint_names]
        shown = figure.axes[3].lines[1].get_ydata()
        np.testing.assert_array_equal(shown, run.arrays.command.effort[:, 1])
        assert pyplot.fignum_exists(figure.number)
    finally:
        pyplot.close(figure)
