"""Laws go by the measured momentum of the wheels where the state has it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import space_robot as sr
from space_robot_control.laws.base import Law
from space_robot_control.laws.registry import make_law
from space_robot_control.laws.switching import Switching
from space_robot_control.wheel_momentum import WheelMomentum
from space_robot_description import Robot, load_robot
from space_robot_description.inertia import inertial_parameters

PERIOD, TICKS = 0.1, 100
MOVE = {"kind": "quintic", "duration": 9.0, "attitude_deg": [40, 0, 0], "joints_by_deg": 20}
MEASURED = {"plant.sensors.wheel_momentum": {"noise": 1e-4, "quantisation": 1e-5}}
HALF = [{"kind": "wheel_effectiveness", "wheel": wheel, "factor": 0.5, "at": 0.0} for wheel in range(3)]


def plant_of(**keys: Any) -> sr.SteppedPlant:
    """Mini with its payload on a motion that turns the base."""
    task: dict[str, Any] = {"control_period": PERIOD, "duration": TICKS * PERIOD, "reference": MOVE}
    return sr.make_plant("compare/mini", task | keys)


def believing(robot: Robot, momentum: tuple[float, float, float]) -> Robot:
    """The robot whose wheels are thought to start with this momentum."""
    wheels = robot.actuators.base_torque.model_copy(update={"initial_momentum": momentum})
    return replace(robot, actuators=robot.actuators.model_copy(update={"base_torque": wheels}))


def attitude_error(law: Law, plant: sr.SteppedPlant) -> float:
    """Root mean square over the motion [deg]."""
    law.reset()
    errors = []
    for _ in range(TICKS):
        reference = plant.reference
        cosine = abs(float(plant.sample.telemetry["true_configuration"][3:7] @ reference.q[3:7]))
        errors.append(2.0 * np.degrees(np.arccos(min(1.0, cosine))))
        plant.step(law.update(plant.state, reference).command)
    return float(np.sqrt(np.mean(np.square(errors))))


@pytest.mark.parametrize("name", ["computed_torque", "ntsmc", "adaptive"])
def test_a_reading_corrects_a_wrong_belief_of_the_momentum(name: str) -> None:
    """A law that starts from another momentum than the wheels have follows several times closer with the reading."""

    def error(keys: Mapping[str, Any]) -> float:
        plant = plant_of(**keys)
        gains = {"update": "none"} if name == "adaptive" else {}
        return attitude_error(make_law(name, believing(plant.robot, (0.0, 1.0, -1.5)), PERIOD, gains), plant)

    assert error(MEASURED) < error({}) / 3.0


@pytest.mark.parametrize(("source", "learns"), [("measured", True), ("commanded", False)])
def test_least_squares_learn_from_the_torque_that_acted(source: str, learns: bool) -> None:
    """Of wheels that give half of what is commanded readings say so; commands make another robot of it."""
    plant = plant_of(**MEASURED, faults=HALF)
    law, truth = make_law("adaptive", plant.robot, PERIOD, {"rls": {"wheel_torque": source}}), plant.robot
    attitude_error(law, plant)
    telemetry = law.update(plant.state, plant.reference).telemetry
    base, known = telemetry["parameters"][:10], inertial_parameters(truth)[0]
    off = np.abs(base - known).max() / np.abs(known).max()
    assert (off < 0.02, telemetry["resets"][0] == 0.0) == (learns, learns)
    assert learns or off > 0.2


def test_a_saturated_period_teaches_where_the_wheels_are_measured() -> None:
    """A step that asks for more torque than there is: by commands the period is left out, by readings it is learned."""
    learned = {}
    for source in ("measured", "commanded"):
        plant = plant_of(**MEASURED, reference={"kind": "step", "attitude_deg": [60, 0, 0]})
        law = make_law("adaptive", plant.robot, PERIOD, {"rls": {"wheel_torque": source}})
        command = law.update(plant.state, plant.reference).command
        assert np.abs(command.wrench[3:]).max() > 1.5
        plant.step(command)
        learned[source] = law.update(plant.state, plant.reference).telemetry["learned"][0]
    assert learned == {"measured": 1.0, "commanded": 0.0}


def test_laws_that_take_turns_share_the_reading() -> None:
    """Whichever answers, all count what was measured, and the next one starts from it."""
    plant = plant_of(**MEASURED)
    laws = {name: make_law(name, plant.robot, PERIOD) for name in ("computed_torque", "ntsmc")}
    switching = Switching(plant.robot, PERIOD, laws, switches=[(500_000_000, "ntsmc")])
    switching.reset()
    for _ in range(10):
        output, reading = switching.control(plant.state, plant.reference), plant.state.wheel_momentum
        assert reading is not None
        reckoned = reading - PERIOD * output.command.wrench[3:]
        for law in laws.values():
            np.testing.assert_allclose(law.wheels.momentum, reckoned, atol=1e-12)
        plant.step(output.command)
    assert switching.active == "ntsmc"


def test_a_reading_tells_what_three_wheels_hold() -> None:
    """After a reading the reckoning goes on from it, and clips at the momentum that is left."""
    wheels, robot = WheelMomentum(load_robot("mini")), load_robot("mini")
    wheels.measure(np.array([0.0, 0.0, 1.9]))
    torque = np.array([0.0, 0.0, 0.0, 0.0, 0.0, -1.0, *np.zeros(robot.n)])
    wheels.apply(torque, 0.5)
    np.testing.assert_allclose(wheels.momentum, [0.0, 0.0, 2.0], atol=1e-15)
    wheels.measure(np.array([0.0, 0.0, 1.5]))
    measured = wheels.measured
    assert measured is not None
    middle, acted = measured
    np.testing.assert_allclose(middle, [0.0, 0.0, 1.7], atol=1e-15)
    np.testing.assert_allclose(acted, [0.0, 0.0, 0.8], atol=1e-14)
    wheels.apply(torque, 0.2)
    np.testing.assert_allclose(wheels.momentum, [0.0, 0.0, 1.7], atol=1e-15)
    wheels.measure(None)
    assert wheels.measured is None
    np.testing.assert_allclose(wheels.momentum, [0.0, 0.0, 1.7], atol=1e-15)
    assert not wheels.at_start().momentum.any()
