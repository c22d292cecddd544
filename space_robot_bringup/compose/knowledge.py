"""What the flight software knows of the real robot."""

from __future__ import annotations

from dataclasses import replace

from space_robot_bringup.experiment.experiment import Experiment, NominalSpec
from space_robot_bringup.experiment.plant import ModelSpec
from space_robot_description.payload import known_part
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.errors import SpecError


def nominal_spec(experiment: Experiment) -> ModelSpec:
    """What ``nominal`` says, with its payload where it says a fraction of the real one.

    Raises:
        SpecError: there is no real one.
    """
    nominal, real = experiment.nominal, experiment.plant.payload
    if nominal.payload_known is None:
        return nominal
    if real is None:
        accepted = "a plant.payload to know of"
        raise SpecError(
            "there is no payload", key="nominal.payload_known", value=nominal.payload_known, accepted=accepted
        )
    payload = known_part(real, nominal.payload_known) if nominal.payload_known else None
    return nominal.model_copy(update={"payload": payload})


def with_knowledge(nominal: Robot, known: NominalSpec) -> Robot:
    """The nominal robot with what laws know beside its masses: delay, friction and momentum of the wheels.

    Raises:
        SpecError: the robot has no wheels that laws could know nothing of.
    """
    if not known.wheels and not isinstance(nominal.actuators.base_torque, ReactionWheels):
        accepted = "a robot with reaction wheels, or true"
        raise SpecError("there are no wheels", key="nominal.wheels", value=known.wheels, accepted=accepted)
    return replace(nominal, command_delay=known.delay_periods, knows_friction=known.friction, knows_wheels=known.wheels)
