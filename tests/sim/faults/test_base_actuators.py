"""Faults of wheels and thrusters: what acts on the base, and that momentum stays accounted for."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_msgs_py.interfaces import Vector
from tests.sim.faults.support import WHEELS, balances, block, fault, lively, simulated

ONSET, END = 10, 25
WINDOW = {"for": 1.5}
AXES = ("force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z")


def nothing(tick: int) -> tuple[Vector, Vector]:
    """No command."""
    return np.zeros(6), np.zeros(7)


def test_a_seized_wheel_gives_its_momentum_to_the_body_once() -> None:
    """Its momentum is gone after one period and stays zero; the whole keeps its momentum."""
    samples = simulated([fault("wheel_stopped", wheel=2)], actuators=WHEELS)
    stored, total = block(samples, "wheel_momentum")[:, 2], block(samples, "momentum")
    assert abs(stored[ONSET]) > 1.0
    np.testing.assert_allclose(stored[ONSET + 1 :], 0.0, atol=1e-12)
    np.testing.assert_allclose(total - total[0], 0.0, atol=1e-10)
    assert balances(samples)


@pytest.mark.parametrize("factor", [0.0, 0.3])
def test_a_weak_wheel_gives_a_part(factor: float) -> None:
    """Its rate is factor times that of a healthy one, other wheels give what they gave."""
    weak = np.diff(
        block(simulated([fault("wheel_effectiveness", wheel=1, factor=factor)], actuators=WHEELS), "wheel_momentum"),
        axis=0,
    )
    well = np.diff(block(simulated([], actuators=WHEELS), "wheel_momentum"), axis=0)
    np.testing.assert_allclose(weak[ONSET:, 1], factor * well[ONSET:, 1], atol=1e-13)
    np.testing.assert_allclose(np.delete(weak, 1, axis=1), np.delete(well, 1, axis=1), atol=1e-13)
    np.testing.assert_allclose(weak[:ONSET], well[:ONSET], atol=1e-13)


def test_a_bias_turns_the_wheel_by_itself() -> None:
    """Without a command the wheel gains torque times time, and the body the opposite."""
    samples = simulated([fault("wheel_bias", wheel=0, torque=0.5, **WINDOW)], actuators=WHEELS, commands=nothing)
    stored = block(samples, "wheel_momentum")[:, 0]
    gained = stored - stored[0]
    np.testing.assert_allclose(gained[[ONSET, ONSET + 1, END, -1]], [0.0, 0.05, 0.75, 0.75], atol=1e-12)
    assert balances(samples)


def test_drag_stops_a_wheel_and_no_more() -> None:
    """The wheel slows down by torque times time and never turns the other way."""
    stored = block(
        simulated([fault("wheel_friction", wheel=0, torque=0.7)], actuators=WHEELS, commands=nothing), "wheel_momentum"
    )
    assert stored[ONSET + 1, 0] == pytest.approx(1.0 - 0.07, abs=1e-12)
    assert stored[-1, 0] == pytest.approx(0.0, abs=1e-12)
    assert stored[:, 0].min() > -1e-12


def test_an_early_limit_keeps_what_is_stored() -> None:
    """Beyond the new limit a wheel takes nothing more, gives back, and loses nothing by itself."""
    samples = simulated([fault("wheel_limit", wheel=2, momentum=0.5)], actuators=WHEELS)
    stored = np.abs(block(samples, "wheel_momentum")[:, 2])
    assert stored[ONSET] > 3.0
    assert np.all(stored[ONSET + 1 :] <= np.maximum(0.5, stored[ONSET:-1]) + 1e-12)
    assert stored[-1] == pytest.approx(0.5, abs=1e-12)
    assert balances(samples)


@pytest.mark.parametrize("axis", AXES)
def test_thrusters_stuck_off_stuck_on_and_weak(axis: str) -> None:
    """Off gives nothing, on gives the limit, weak a part of the command; other axes are as commanded."""
    channel, limits = AXES.index(axis), {
        "base_force": {"kind": "thrusters", "limit": (7.0, 8.0, 9.0)},
        "base_torque": {"kind": "thrusters", "limit": (7.0, 8.0, 9.0)},
    }  # fmt: skip
    limit = (7.0, 8.0, 9.0)[channel % 3]
    commanded = np.array([lively(tick)[0] for tick in range(40)])
    for kind, keys, expected in (
        ("thruster_stuck_off", {}, 0.0 * commanded[:, channel]),
        ("thruster_stuck_on", {"direction": -1}, np.full(40, -limit)),
        ("thruster_weak", {"factor": 0.25}, 0.25 * commanded[:, channel]),
    ):
        samples = simulated([fault(kind, axis=axis, **WINDOW, **keys)], actuators=limits)
        wrench = block(samples, "applied_wrench")[1:]
        np.testing.assert_allclose(wrench[ONSET:END, channel], expected[ONSET:END], rtol=1e-12)
        np.testing.assert_allclose(
            np.delete(wrench, channel, axis=1), np.delete(commanded, channel, axis=1), rtol=1e-12
        )
        np.testing.assert_allclose(wrench[END:, channel], commanded[END:, channel], rtol=1e-12)
        assert balances(samples)


def test_a_leak_pushes_beside_the_command_also_of_pulsed_thrusters() -> None:
    """The mean wrench of a period is what is commanded and the leak, and its impulse is accounted for."""
    pulsed = {"base_force": {"kind": "thrusters", "limit": (20.0,) * 3, "pwm": True}}
    for actuators in ({}, pulsed):
        samples = simulated([fault("thruster_leaking", axis="force_y", level=0.5, **WINDOW)], actuators=actuators)
        wrench, commanded = (
            block(samples, "applied_wrench")[1:, 1],
            np.array([lively(tick)[0][1] for tick in range(40)]),
        )
        np.testing.assert_allclose(wrench[ONSET:END] - commanded[ONSET:END], 0.5, rtol=1e-10)
        np.testing.assert_allclose(wrench[:ONSET], commanded[:ONSET], rtol=1e-12)
        assert balances(samples, 1e-8)


def test_a_pulse_acts_where_nothing_else_can() -> None:
    """Force and torque from outside act on a robot with wheels alone; momentum changes by their impulse."""
    push = {"force": (0.0, 3.0, 0.0), "torque": (0.1, 0.0, 0.0)}
    samples = simulated([fault("wrench_pulse", **push, **WINDOW)], actuators=WHEELS, commands=nothing)
    momentum = block(samples, "momentum")
    np.testing.assert_allclose(np.linalg.norm(momentum[ONSET, :3] - momentum[0, :3]), 0.0, atol=1e-11)
    assert np.linalg.norm(momentum[END, :3] - momentum[ONSET, :3]) == pytest.approx(3.0 * 1.5, rel=0.05)
    np.testing.assert_allclose(momentum[-1], momentum[END], atol=1e-10)
    assert balances(samples)
