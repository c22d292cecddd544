"""What flexible gears cannot be combined with."""

from __future__ import annotations

from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import SpecError
from space_robot_sim.faults.joints import JointBrakeWeak, JointStuck
from space_robot_sim.faults.plan import FaultPlan
from space_robot_sim.flexible.bodies import KEY
from space_robot_sim.flexible.parts import FlexibleParts


def check_composed(flexible: FlexibleParts, robot: Robot, *, braked: bool, plan: FaultPlan | None) -> None:
    """Refuse brakes of joints whose gears twist: they hold links in this plant, and real ones sit at the motor.

    Args:
        flexible: of the robot.
        robot: the truth.
        braked: its brakes may close in the run.
        plan: of its faults; None: nothing goes wrong.

    Raises:
        SpecError: the message names the key.
    """
    gears = [robot.joint_names[joint] for joint in flexible.motors]
    if gears and braked:
        accepted = "a run whose brakes do not close: without plant.hold.brakes, and brakes in supervision.modes"
        raise SpecError("gears that twist have no brake", key=f"{KEY}.joints", value=gears, accepted=accepted)
    for one in () if plan is None else plan.planned:
        if isinstance(one.fault, JointStuck | JointBrakeWeak) and one.fault.joint in gears:
            accepted = f"a joint that is rigid, or another fault than {one.fault.kind}"
            raise SpecError(
                f"has a gear that twists ({KEY}.joints), which has no brake",
                key=f"faults.{one.index}.joint",
                value=one.fault.joint,
                accepted=accepted,
            )
