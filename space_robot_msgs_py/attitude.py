"""Roll, pitch and yaw of the base in degrees, which any tool plots as they are: derived from what has quaternions."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, isfinite, sqrt
from struct import Struct

from space_robot_msgs_py.codec.cdr import pack_stamp
from space_robot_msgs_py.codec.layout import Layout
from space_robot_msgs_py.codec.message_layouts import BASE_LINK, BASE_LINK_DESIRED, odometry, vector3_stamped
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import atan2
from space_robot_msgs_py.topics import ATTITUDE, BASE_ODOM, REFERENCE_ATTITUDE, REFERENCE_BASE, Topic

_POSE, _ANGLES = Struct("<7d"), Struct("<3d")
# What the angles are derived from, and the frame that is turned.
SOURCES: dict[Topic, tuple[Topic, str]] = {
    ATTITUDE: (BASE_ODOM, BASE_LINK),
    REFERENCE_ATTITUDE: (REFERENCE_BASE, BASE_LINK_DESIRED),
}


class AttitudeAngles:
    """Makes the message of one of the topics in ``SOURCES``.

    Args:
        topic: which.

    Attributes:
        source: the topic whose messages it is made from.
    """

    def __init__(self, topic: Topic) -> None:
        self.source, frame = SOURCES[topic]
        self._odometry: Layout = odometry(self.source.name, frame)
        self._angles: Layout = vector3_stamped(topic.name)

    def of(self, raw: bytes | None) -> bytes | None:
        """The angles of a nav_msgs/Odometry; None where it has other frames, or its quaternion is no rotation.

        Args:
            raw: canonical bytes; None: there is no message.
        """
        if raw is None:
            return None
        try:
            stamp, pose, _ = self._odometry.blocks(raw)
        except LayoutError:
            return None
        return self._filled(stamp, _POSE.unpack(pose)[3:])

    def at(self, stamp: int, quaternion: Vector) -> bytes | None:
        """The angles of a quaternion (4,) x, y, z, w at a stamp [ns]; None where it is no rotation."""
        return self._filled(pack_stamp(stamp), quaternion.tolist())

    def _filled(self, stamp: bytes, quaternion: Sequence[float]) -> bytes | None:
        angles = rpy_degrees(*quaternion)
        return None if angles is None else self._angles.fill(stamp, _ANGLES.pack(*angles))


def rpy_degrees(x: float, y: float, z: float, w: float) -> tuple[float, float, float] | None:
    """Roll, pitch and yaw [deg] of a quaternion of any length, as Rz(yaw) Ry(pitch) Rx(roll); None for no rotation."""
    square = x * x + y * y + z * z + w * w
    if not isfinite(square) or square <= 0.0:
        return None
    sine = 2.0 * (w * y - z * x) / square
    roll = atan2(2.0 * (w * x + y * z), w * w - x * x - y * y + z * z)
    yaw = atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)
    pitch = atan2(sine, sqrt(max(0.0, (1.0 - sine) * (1.0 + sine))))
    return degrees(roll), degrees(pitch), degrees(yaw)
