"""The robot as every other package sees it: names, limits, actuators and one Pinocchio model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from space_robot_description.spec import Actuators
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.mimic import Mimic


@dataclass(frozen=True, eq=False, slots=True)
class Robot:
    """A satellite with an arm; truth and nominal are two of these.

    Attributes:
        name: what people call it.
        urdf: the whole robot as one URDF (root link ``base_link``), as loaded: dispersion and payload are not in it.
        model: ``pin.Model``: JointModelFreeFlyer root, then one-DoF joints (nq_i = nv_i = 1), and JointModelMimic
            without a coordinate for joints that follow one of these; gravity zero. Read only.
        joint_names: (n) joints with a coordinate, in model order.
        body_names: (1+N) base first, then the body each joint moves, followers too: N = n but for these.
        base_mode: ``free_floating``: no force on the base; ``free_flying``: force by thrusters.
        actuators: limits and dynamics of everything that pushes.
        effort_limit: (n,) [N m or N].
        joint_lower: (n,) [rad or m]; may be -inf for continuous joints.
        joint_upper: (n,) [rad or m]; may be +inf.
        joint_rate_limit: (n,) [rad/s or m/s]; may be +inf.
        home: (n,) joint positions to start from when nothing else is said [rad or m].
        command_delay: control periods between the state a command answers and the period it acts in, for the laws;
            the plant has its own.
        knows_friction: laws add the friction of ``actuators.joints`` to their efforts.
        knows_wheels: laws know the momentum of the reaction wheels, measured or reckoned from the commands.
        tool_frame: the link at the end of the arm, in ``model.frames``.
        resolved: the robot file with the URDF inside; ``load_robot`` makes the same robot from it, bit for bit.
        notes: what the robot file changed in the URDF's inertias, a sentence each.
        tools: name -> link of ``model.frames``, of robots with several arms.
        mimics: follower -> the joint of ``joint_names`` that moves it.
    """

    name: str
    urdf: str
    model: Any
    joint_names: tuple[str, ...]
    body_names: tuple[str, ...]
    base_mode: Literal["free_floating", "free_flying"]
    actuators: Actuators
    effort_limit: Vector
    joint_lower: Vector
    joint_upper: Vector
    joint_rate_limit: Vector
    home: Vector
    tool_frame: str = ""
    command_delay: int = 0
    knows_friction: bool = False
    knows_wheels: bool = True
    resolved: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    tools: Mapping[str, str] = field(default_factory=dict)
    mimics: Mapping[str, Mimic] = field(default_factory=dict)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    @property
    def prismatic(self) -> tuple[bool, ...]:
        """(n) True for joints whose position is a length."""
        kinds = [joint.shortname() for joint in self.model.joints[2:] if joint.nv]
        return tuple("JointModelP" in kind for kind in kinds)
