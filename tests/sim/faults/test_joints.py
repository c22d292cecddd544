"""Faults of joints: what each does to the effort that acts, and that momentum and energy stay accounted for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_msgs_py.interfaces import Vector
from tests.sim.faults.support import balances, block, fault, lively, simulated

JOINT, K = "joint_2", 2
ONSET, END = 10, 25
WINDOW = {"joint": JOINT, "for": 1.5}


def applied(kind: str, **keys: Any) -> Vector:
    """(K,) effort of the joint in the period that begins at each tick, and that the run balances."""
    samples = simulated([fault(kind, **(WINDOW | keys))])
    assert balances(samples)
    return block(samples, "applied_effort")[1:, K]


def commanded() -> Vector:
    """(K,) what it was commanded at each tick."""
    return np.array([lively(tick)[1][K] for tick in range(40)])


def outside(efforts: Vector) -> bool:
    """Before and after the window the joint does what it is commanded."""
    same = efforts == commanded()
    return bool(same[:ONSET].all() and same[END:].all())


@pytest.mark.parametrize("kernel", ["auto", "pinocchio"])
def test_a_stuck_joint_stands_still_and_momentum_is_kept(kernel: str) -> None:
    """From the first period of the window to its last the rate is zero and the angle stays, bit for bit."""
    samples = simulated([fault("joint_stuck", **WINDOW)], kernel=kernel)
    rates, angles = block(samples, "true_velocity")[:, 6 + K], block(samples, "true_configuration")[:, 7 + K]
    assert not rates[ONSET + 1 : END + 1].any()
    assert set(angles[ONSET + 1 : END + 1]) == {angles[ONSET]}
    assert rates[ONSET] != 0.0
    assert rates[END + 1] != 0.0
    assert balances(samples)
    assert not block(samples, "applied_effort")[ONSET + 1 : END + 1, K].any()


def test_kernel_and_pinocchio_agree_on_a_brake() -> None:
    """The compiled plant and the one over Pinocchio hold the same joint to 1e-12."""
    faults = [fault("joint_stuck", **WINDOW), fault("joint_stuck", joint="joint_5", at=1.2)]
    ours, theirs = (simulated(faults, kernel=kernel)[-1].telemetry["true_velocity"] for kernel in ("auto", "pinocchio"))
    np.testing.assert_allclose(ours, theirs, atol=1e-12)
    assert ours[6 + 5] == 0.0


def test_a_brake_takes_energy_and_no_momentum() -> None:
    """Closing a brake on a moving joint changes momentum by nothing and kinetic energy downwards."""

    def nothing(tick: int) -> tuple[Vector, Vector]:
        return np.zeros(6), np.zeros(7)

    samples = simulated([fault("joint_stuck", joint=JOINT)], commands=nothing)
    momentum, energy = block(samples, "momentum"), block(samples, "energy")[:, 0]
    np.testing.assert_allclose(momentum - momentum[0], 0.0, atol=1e-11)
    assert energy[ONSET + 1] < energy[ONSET] - 1e-6
    assert balances(samples)


@pytest.mark.parametrize("factor", [0.0, 0.4, 1.0])
def test_effectiveness_is_a_factor_on_what_is_commanded(factor: float) -> None:
    """Applied = factor * commanded in the window, applied = commanded outside of it."""
    efforts = applied("joint_effectiveness", factor=factor)
    assert outside(efforts)
    np.testing.assert_allclose(efforts[ONSET:END], factor * commanded()[ONSET:END], rtol=1e-15)


def test_effectiveness_is_a_factor_on_the_limit_too() -> None:
    """A saturated motor of 40 % gives 40 % of its limit, and is still shown as saturated."""
    limits = {"joints": {"effort": 0.1}}
    samples = simulated([fault("joint_effectiveness", factor=0.4, **WINDOW)], actuators=limits)
    efforts, saturated = block(samples, "applied_effort")[1:, K], block(samples, "saturation")[1:, 6 + K]
    expected = np.clip(commanded(), -0.1, 0.1) * np.where((np.arange(40) >= ONSET) & (np.arange(40) < END), 0.4, 1.0)
    np.testing.assert_allclose(efforts, expected, rtol=1e-15)
    assert np.array_equal(saturated, np.abs(commanded()) > 0.1)


def test_an_offset_is_added() -> None:
    """Applied = commanded + torque in the window."""
    efforts = applied("joint_offset", torque=-0.3)
    assert outside(efforts)
    np.testing.assert_allclose(efforts[ONSET:END], commanded()[ONSET:END] - 0.3, rtol=1e-14)


def test_friction_slows_the_joint_and_costs_energy() -> None:
    """With friction the joint is slower than without, and energy is still accounted for."""
    without = block(simulated([]), "true_velocity")[:, 6 + K]
    samples = simulated([fault("joint_friction", joint=JOINT, viscous=2.0, coulomb=0.2)])
    rates = block(samples, "true_velocity")[:, 6 + K]
    np.testing.assert_allclose(rates[: ONSET + 1], without[: ONSET + 1], atol=1e-8)
    assert np.abs(rates[ONSET + 5 :]).max() < 0.3 * np.abs(without[ONSET + 5 :]).max()
    assert balances(samples)


def test_a_free_joint_has_neither_motor_nor_friction() -> None:
    """No effort acts and nothing rubs: with all joints free and no force, energy is kept."""

    def after_onset(tick: int) -> tuple[Vector, Vector]:
        wrench, effort = lively(tick)
        return (wrench if tick < ONSET else np.zeros(6)), effort

    rough = {"joints": {"effort": 1e3, "viscous": 0.3, "coulomb": 0.02}}
    samples = simulated(
        [fault("joint_free", joint=f"joint_{k}") for k in range(7)], actuators=rough, commands=after_onset
    )
    energy = block(samples, "energy")[ONSET:, 0]
    np.testing.assert_allclose(energy, energy[0], rtol=1e-7)
    assert not block(samples, "applied_effort")[ONSET + 1 :].any()
    assert balances(samples)


@pytest.mark.parametrize("direction", [1, -1])
def test_a_runaway_joint_pushes_with_all_it_has(direction: int) -> None:
    """The limit acts in the direction of the fault, whatever is commanded."""
    samples = simulated([fault("joint_runaway", direction=direction, **WINDOW)], actuators={"joints": {"effort": 0.9}})
    efforts = block(samples, "applied_effort")[1:, K]
    assert set(efforts[ONSET:END]) == {direction * 0.9}
    assert outside(efforts)


def test_play_swallows_effort_after_each_reversal() -> None:
    """After a reversal nothing is passed on until the play is crossed, later all of it."""
    efforts, wanted = applied("joint_backlash", joint=JOINT, play=0.25, speed=1.0, **{"for": 3.0}), commanded()
    # 0.125 rad to the first flank at 1 rad/s: a period, and a quarter of the next.
    assert efforts[ONSET] == 0.0
    np.testing.assert_allclose(efforts[ONSET + 1], 0.75 * wanted[ONSET + 1], rtol=1e-12)
    assert efforts[ONSET + 2] == wanted[ONSET + 2]
    (turn,) = [k for k in range(ONSET + 2, 20) if wanted[k] * wanted[k - 1] < 0.0]
    np.testing.assert_allclose(
        efforts[turn : turn + 3], np.array([0.0, 0.0, 0.5]) * wanted[turn : turn + 3], atol=1e-12
    )
    assert efforts[turn + 3] == wanted[turn + 3]


@pytest.mark.parametrize("direction", [1, -1])
def test_a_false_limit_switch_cuts_one_direction(direction: int) -> None:
    """Effort towards the end is cut, effort away from it acts."""
    efforts, wanted = applied("joint_limit_switch", direction=direction)[ONSET:END], commanded()[ONSET:END]
    towards = wanted * direction > 0.0
    assert towards.any()
    assert not towards.all()
    assert not efforts[towards].any()
    assert np.array_equal(efforts[~towards], wanted[~towards])
