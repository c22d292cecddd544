"""What `/tf` and `/tf_static` say, made from a URDF and the measured state: any 3-D tool then shows the robot."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np

from space_robot_msgs_py.cdr import pack_stamp
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import RobotState, Vector
from space_robot_msgs_py.message_layouts import INERTIAL, tf_message
from space_robot_msgs_py.topics import TF, TF_STATIC
from space_robot_msgs_py.urdf_frames import FrameJoint, product, read_frames, rotated
from space_robot_msgs_py.value_codecs import StateCodec


class FrameTransforms:
    """The frames of a robot as tf2_msgs/TFMessage: `inertial` to the root link, then every link in its parent.

    A text that is no URDF with one root link has no frames: ``static`` and what ``of`` returns are then None.

    Args:
        urdf: the robot, as it is on ``robot_description``.
        joint_names: the robot's joints in model order; all other joints stand still.

    Attributes:
        static: the message on ``/tf_static``; None where no joint is fixed.
    """

    def __init__(self, urdf: str, joint_names: Sequence[str]) -> None:
        root, joints = read_frames(urdf)
        fixed = [joint for joint in joints.values() if joint.name not in joint_names]
        moving = [joints[name] for name in joint_names if name in joints]
        self._index = [index for index, name in enumerate(joint_names) if name in joints]
        self._states = StateCodec(joint_names)
        pairs = [(INERTIAL, root or ""), *((joint.parent, joint.child) for joint in moving)]
        self._layout = tf_message(TF.name, pairs) if root else None
        self.static = _static(fixed)
        self._basis = _basis(moving)

    def of(self, state: RobotState) -> bytes | None:
        """The message on ``/tf`` at a state."""
        return self._at(pack_stamp(state.stamp), state.q[:7], state.joints)

    def from_messages(self, odometry: bytes | None, joints: bytes | None) -> bytes | None:
        """The message on ``/tf`` from base/odom and joint_states; None where they are not a state of this robot."""
        if self._layout is None or odometry is None or joints is None:
            return None
        base, arm, _ = self._states.layouts
        try:
            stamp, pose, _ = base.blocks(odometry)
            position = arm.blocks(joints)[1]
        except LayoutError:
            return None
        return self._at(stamp, np.frombuffer(pose), np.frombuffer(position))

    def _at(self, stamp: bytes, pose: Vector, joints: Vector) -> bytes | None:
        position = joints[self._index]
        if self._layout is None or not isfinite(sum(pose.tolist()) + sum(position.tolist())):
            return None
        constant, linear, cosine, sine = self._basis
        half = 0.5 * position[:, None]
        # A rotation about a fixed axis is linear in the cosine and the sine of its half angle.
        places = constant + half * linear + np.cos(half) * cosine + np.sin(half) * sine
        blocks = [stamp, pose.tobytes()]
        for place in places:
            blocks += stamp, place.tobytes()
        return self._layout.fill(*blocks)


def _basis(joints: Sequence[FrameJoint]) -> tuple[Vector, Vector, Vector, Vector]:
    """Four (n, 7) arrays: translation and quaternion are constant + half linear + cos(half) cosine + sin(half) sine."""
    constant, linear, cosine, sine = (np.zeros((len(joints), 7)) for _ in range(4))
    for row, joint in enumerate(joints):
        constant[row, :3] = joint.translation
        if joint.prismatic:
            constant[row, 3:] = joint.rotation
            linear[row, :3] = 2.0 * rotated(joint.rotation, joint.axis)
        else:
            cosine[row, 3:] = joint.rotation
            sine[row, 3:] = product(joint.rotation, np.append(joint.axis, 0.0))
    return constant, linear, cosine, sine


def _static(joints: Sequence[FrameJoint]) -> bytes | None:
    if not joints:
        return None
    layout = tf_message(TF_STATIC.name, [(joint.parent, joint.child) for joint in joints])
    blocks: list[bytes] = []
    for joint in joints:
        blocks += pack_stamp(0), joint.translation.tobytes() + joint.rotation.tobytes()
    return layout.fill(*blocks)
