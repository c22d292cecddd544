"""The records of an ordinary tick, made at once: one pattern for all its messages, whose numbers are put in.

Most ticks of a run have the same ten messages of the same sizes. Made one by one they take twice as long.
"""

from __future__ import annotations

from struct import Struct

from space_robot_msgs_py.codec.cdr import pack_stamp
from space_robot_msgs_py.codec.codecs import LOGGED, TickCodec
from space_robot_msgs_py.codec.layout import Layout
from space_robot_msgs_py.codec.telemetry import MAX_STAMP
from space_robot_msgs_py.interfaces import Telemetry, Tick
from space_robot_msgs_py.log.preamble import CHANNELS
from space_robot_msgs_py.log.row_form import NONE, TIMES, head_of
from space_robot_msgs_py.topics import (
    BASE_IMU,
    BASE_ODOM,
    CONTROLLER_TELEMETRY,
    JOINT_COMMAND,
    JOINT_STATES,
    PLANT_TELEMETRY,
    REFERENCE_BASE,
    REFERENCE_BASE_ACCEL,
    REFERENCE_JOINTS,
    WRENCH_COMMAND,
    Topic,
)

# What goes into the holes of each message, by its name in ``_pieces``.
_HOLES: dict[Topic, tuple[str, ...]] = {
    BASE_ODOM: ("time", "pose", "twist"),
    JOINT_STATES: ("time", "position", "velocity", "effort"),
    BASE_IMU: ("time", "orientation", "rate", "acceleration"),
    REFERENCE_BASE: ("time", "desired_pose", "desired_twist"),
    REFERENCE_BASE_ACCEL: ("time", "desired_acceleration"),
    REFERENCE_JOINTS: ("time", "desired_position", "desired_velocity", "desired_joint_acceleration"),
    WRENCH_COMMAND: ("time", "wrench"),
    JOINT_COMMAND: ("time", "joint_command"),
    CONTROLLER_TELEMETRY: ("number", "controller"),
    PLANT_TELEMETRY: ("number", "plant"),
}
_DOUBLE = Struct("<d")
Shape = tuple[tuple[str, ...], tuple[int, ...]]


class TickBlock:
    """Makes the records of ticks that are like one of them.

    Args:
        codec: of the robot.
        tick: an ordinary one, see ``ordinary``.

    Attributes:
        names: of the topics of the records, in their order.
        sizes: of the messages of ``LOGGED`` [bytes], or ``NONE``.
    """

    def __init__(self, codec: TickCodec, tick: Tick) -> None:
        parts = (codec.state, codec.reference, codec.command)
        layouts = {topic: one for part in parts for topic, one in zip(part.topics, part.layouts, strict=True)}
        self._shapes = _shape(tick.output.telemetry), _shape(tick.sample.telemetry)
        layouts[CONTROLLER_TELEMETRY] = codec.controller_telemetry.layout_for(self._shapes[0])
        layouts[PLANT_TELEMETRY] = codec.plant_telemetry.layout_for(self._shapes[1])
        self._joints = len(tick.sample.state.effort)
        topics = [topic for topic in LOGGED if topic in _HOLES]
        self.names = tuple(topic.name for topic in topics)
        self.sizes = tuple([layouts[topic].size if topic in _HOLES else NONE for topic in LOGGED])
        self._pattern = b"".join(_record(topic, layouts[topic]) for topic in topics)

    def fits(self, tick: Tick) -> bool:
        """The tick has these messages and sizes, and one stamp."""
        sample, output, reference, stamp = tick.sample, tick.output, tick.reference, tick.stamp
        state, command = sample.state, output.command
        return (
            ordinary(tick)
            and state.stamp == reference.stamp == command.stamp == output.telemetry.stamp == stamp < MAX_STAMP
            and sample.telemetry.stamp == stamp
            and len(state.effort) == len(command.effort) == len(reference.q) - 7 == self._joints
            and (_shape(output.telemetry), _shape(sample.telemetry)) == self._shapes
        )

    def records(self, tick: Tick, sequence: int) -> bytes:
        """The records of a tick that fits.

        Args:
            tick: it.
            sequence: number of the message, on each of the topics.
        """
        pieces = _pieces(tick)
        pieces[b"times"] = TIMES.pack(sequence, tick.stamp, tick.stamp)
        return self._pattern % pieces


def ordinary(tick: Tick) -> bool:
    """Nothing happened in a tick that has topics of its own, and no supervisor is there."""
    sample = tick.sample
    happened = tick.output.events or sample.faults or sample.events
    return not happened and tick.supervision is None and sample.state.wheel_momentum is None


def _pieces(tick: Tick) -> dict[bytes, bytes]:
    state, reference, output = tick.sample.state, tick.reference, tick.output
    q, v = state.q.tobytes(), state.v.tobytes()
    desired_q, desired_v, desired_a = reference.q.tobytes(), reference.v.tobytes(), reference.a.tobytes()
    return {
        b"time": pack_stamp(tick.stamp),
        b"number": _DOUBLE.pack(tick.stamp),
        b"pose": q[:56],
        b"orientation": q[24:56],
        b"position": q[56:],
        b"twist": v[:48],
        b"rate": v[24:48],
        b"velocity": v[48:],
        b"effort": state.effort.tobytes(),
        b"acceleration": state.base_acceleration.tobytes(),
        b"desired_pose": desired_q[:56],
        b"desired_position": desired_q[56:],
        b"desired_twist": desired_v[:48],
        b"desired_velocity": desired_v[48:],
        b"desired_acceleration": desired_a[:48],
        b"desired_joint_acceleration": desired_a[48:],
        b"wrench": output.command.wrench.tobytes(),
        b"joint_command": output.command.effort.tobytes(),
        b"controller": output.telemetry.data.tobytes(),
        b"plant": tick.sample.telemetry.data.tobytes(),
    }


def _shape(telemetry: Telemetry) -> Shape:
    return telemetry.labels, telemetry.sizes


def _record(topic: Topic, layout: Layout) -> bytes:
    head = head_of(CHANNELS[topic.name], layout.size)
    return head.replace(b"%", b"%%") + b"%(times)b" + layout.pattern(_HOLES[topic])
