"""What fits the nominal actuators: boxes, wheels in any number, and the direction that a scale keeps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_control.command_limits import CommandLimits
from space_robot_description.load import load_robot
from space_robot_msgs_py.interfaces import Vector
from tests.support.robots import arm_model, robot_of

N = 3
PYRAMID = [(1.0, 0.0, 1.0), (-1.0, 0.0, 1.0), (0.0, 1.0, 1.0), (0.0, -1.0, 1.0)]
BOX: dict[str, Any] = {
    "joints": {"effort": 5.0},
    "base_torque": {"kind": "ideal", "limit": (2.0, 3.0, 4.0)},
    "base_force": {"kind": "thrusters", "limit": (10.0, 10.0, 10.0)},
}
WHEELS: dict[str, Any] = {
    "joints": {"effort": 5.0},
    "base_torque": {"kind": "reaction_wheels", "axes": PYRAMID, "torque": 1.0, "momentum": 9.0},
    "base_force": None,
}


def limits(actuators: dict[str, Any]) -> CommandLimits:
    return CommandLimits(robot_of(arm_model(N), actuators, floating=actuators is WHEELS))


def commands(actuators: dict[str, Any], scale: float) -> list[Vector]:
    drawn = np.random.default_rng(2).normal(size=(50, 6 + N)) * scale
    drawn[:, :3] *= actuators["base_force"] is not None
    return list(drawn)


@pytest.mark.parametrize("actuators", [BOX, WHEELS], ids=["box", "wheels"])
def test_fitted_commands_fit(actuators: dict[str, Any]) -> None:
    """Both ways end within every limit (to rounding), and this with commands and biases that do not and do fit."""
    able, bias = limits(actuators), commands(actuators, 0.1)[1]
    assert able.fits(bias)
    for u in commands(actuators, 8.0):
        assert not able.fits(u)
        assert able.fits((1.0 - 1e-12) * able.per_axis(u))
        assert able.fits((1.0 - 1e-12) * able.direction_preserving(u, np.zeros(6 + N)))
        assert able.fits((1.0 - 1e-12) * able.direction_preserving(u, bias))


@pytest.mark.parametrize(("actuators", "rounding"), [(BOX, 0.0), (WHEELS, 1e-15)], ids=["box", "wheels"])
def test_commands_that_fit_stay(actuators: dict[str, Any], rounding: float) -> None:
    """A command that fits is left alone, bit for bit; per axis the way to the wheels and back rounds."""
    able = limits(actuators)
    for u in commands(actuators, 0.1):
        assert able.fits(u)
        assert np.abs(able.per_axis(u) - u).max() <= rounding
        assert able.direction_preserving(u, u - 1.0).tobytes() == u.tobytes()


@pytest.mark.parametrize("actuators", [BOX, WHEELS], ids=["box", "wheels"])
def test_the_scale_keeps_the_direction_from_the_bias_and_is_the_largest(actuators: dict[str, Any]) -> None:
    """What goes beyond C0 keeps its direction; one per mille more does not fit."""
    able, bias = limits(actuators), commands(actuators, 0.3)[0]
    for u in commands(actuators, 8.0):
        fitted = able.direction_preserving(u, bias)
        alpha = (fitted - bias) @ (u - bias) / ((u - bias) @ (u - bias))
        assert 0.0 < alpha < 1.0
        np.testing.assert_allclose(fitted, bias + alpha * (u - bias), atol=1e-12)
        assert not able.fits(bias + 1.001 * alpha * (u - bias))


def test_a_bias_beyond_the_limits_leaves_no_room() -> None:
    """Where C0 alone does not fit the rest is given up, and the answer is C0, clipped."""
    able, bias, u = limits(BOX), np.zeros(6 + N), np.zeros(6 + N)
    bias[6], u[6], u[7] = 6.0, 7.0, 1.0
    clipped = [*bias[:6], 5.0, 0.0, 0.0]
    assert able.direction_preserving(u, bias).tolist() == clipped
    assert able.direction_preserving(bias, bias).tolist() == clipped


def test_limits_are_those_of_the_robot_file() -> None:
    """Forces, torques and efforts of the servicer, and the wheels of mini, bound as written."""
    able = CommandLimits(load_robot("servicer"))
    assert able.per_axis(np.full(14, 1e3)).tolist() == [60.0] * 3 + [20.0] * 3 + [200, 200, 200, 150, 100, 80, 80, 80]
    np.testing.assert_allclose(CommandLimits(load_robot("mini")).per_axis(np.full(10, 1e3))[3:], [1.5] * 3 + [5.0] * 4)
