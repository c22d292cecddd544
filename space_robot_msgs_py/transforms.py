"""What `/tf` and `/tf_static` say, made from a URDF and the measured state: any 3-D tool then shows the robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from struct import Struct

import numpy as np

from space_robot_msgs_py.codec.cdr import pack_stamp
from space_robot_msgs_py.codec.message_layouts import INERTIAL, tf_message
from space_robot_msgs_py.codec.values import StateCodec
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import RobotState, Vector
from space_robot_msgs_py.kernel.elementary import sincos
from space_robot_msgs_py.mimic import Mimic
from space_robot_msgs_py.topics import TF, TF_STATIC
from space_robot_msgs_py.urdf_frames import FrameJoint, product, read_frames, rotated


class FrameTransforms:
    """The frames of a robot as tf2_msgs/TFMessage: `inertial` to the root link, then every link in its parent.

    A text that is no URDF with one root link has no frames: ``static`` and what ``of`` returns are then None.

    Args:
        urdf: the robot, as it is on ``robot_description``.
        joint_names: the robot's joints in model order; of all others those move that follow one of them by ``<mimic>``.

    Attributes:
        static: the message on ``/tf_static``; None where no joint is fixed.
    """

    def __init__(self, urdf: str, joint_names: Sequence[str]) -> None:
        root, joints = read_frames(urdf)
        leading = [joints[name] for name in joint_names if name in joints]
        following = _followers(joints, joint_names)
        moving = [*leading, *(joints[name] for name in following)]
        fixed = [joint for joint in joints.values() if joint not in moving]
        index = [joint_names.index(following[one.name].joint if one.name in following else one.name) for one in moving]
        self._index = slice(None) if index == list(range(len(joint_names))) else index
        self._ways = _ways(len(leading), [*following.values()])
        self._states = StateCodec(joint_names)
        pairs = [(INERTIAL, root or ""), *((joint.parent, joint.child) for joint in moving)]
        self._form = tf_message(TF.name, pairs) if root else None
        self._split = Struct("56s" * len(moving))
        self.static = _static(fixed)
        self._basis = _basis(moving)

    def of(self, state: RobotState) -> bytes | None:
        """The message on ``/tf`` at a state."""
        return self._at(pack_stamp(state.stamp), state.q[:7].tobytes(), state.joints)

    def from_messages(self, odometry: bytes | None, joints: bytes | None) -> bytes | None:
        """The message on ``/tf`` from base/odom and joint_states; None where they are not a state of this robot."""
        if self._form is None or odometry is None or joints is None:
            return None
        base, arm, _ = self._states.layouts
        try:
            stamp, pose, _ = base.blocks(odometry)
            position = arm.blocks(joints)[1]
        except LayoutError:
            return None
        if not isfinite(sum(memoryview(pose).cast("d")) + sum(memoryview(position).cast("d"))):
            return None
        return self._at(stamp, pose, np.frombuffer(position))

    def _at(self, stamp: bytes, pose: bytes, joints: Vector) -> bytes | None:
        if self._form is None:
            return None
        constant, linear, cosine, sine = self._basis
        half = (0.5 * joints)[self._index].reshape(-1, 1)
        if self._ways is not None:
            half = self._ways[0] * half + self._ways[1]
        # A rotation about a fixed axis is linear in the cosine and the sine of its half angle.
        turns = np.array([sincos(one) for one in half.ravel().tolist()]).reshape(-1, 2)
        places = turns[:, 1:] * cosine
        places += turns[:, :1] * sine
        places += half * linear
        places += constant
        blocks = [stamp] * (2 + 2 * len(places))
        blocks[1::2] = pose, *self._split.unpack(places.tobytes())
        return self._form.fill(*blocks)


def _followers(joints: Mapping[str, FrameJoint], names: Sequence[str]) -> dict[str, Mimic]:
    """The joints that follow one of these names, each with what it makes of that one's position."""
    found = {}
    for name, joint in joints.items():
        mimic = None if name in names else joint.mimic
        # No chain is longer than there are joints; a circle leads nowhere.
        for _ in joints:
            if mimic is None or mimic.joint in names:
                break
            above = joints[mimic.joint].mimic if mimic.joint in joints else None
            mimic = None if above is None else mimic.through(above)
        if mimic is not None and mimic.joint in names:
            found[name] = mimic
    return found


def _ways(leading: int, following: Sequence[Mimic]) -> tuple[Vector, Vector] | None:
    """Two (n, 1) arrays, what half of a position is multiplied with and what is added; None where nothing follows."""
    if not following:
        return None
    multiplier = [1.0] * leading + [one.multiplier for one in following]
    offset = [0.0] * leading + [0.5 * one.offset for one in following]
    return np.array(multiplier).reshape(-1, 1), np.array(offset).reshape(-1, 1)


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
