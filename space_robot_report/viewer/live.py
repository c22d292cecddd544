"""A run in the browser while it goes on."""

from __future__ import annotations

from contextlib import ExitStack, suppress
from time import monotonic
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_bringup.logs.happened import happened_at
from space_robot_description.visual import look_of
from space_robot_msgs_py.codec.codecs import CommandCodec, ReferenceCodec, StateCodec, SupervisionCodec
from space_robot_msgs_py.codec.values import PartsCodec
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import NANOSECONDS, RobotState, Vector
from space_robot_msgs_py.topics import (
    BASE_ODOM,
    CONTROLLER_EVENTS,
    EVENTS,
    FAULTS,
    PLANT_EVENTS,
    SUPERVISOR_MODE,
    Topic,
)
from space_robot_report.live.brief import Brief
from space_robot_report.live.feed import Feed
from space_robot_report.playback import way_of
from space_robot_report.viewer.live_panel import LivePanel
from space_robot_report.viewer.motion import Moment
from space_robot_report.viewer.serve import address_of, served
from space_robot_report.viewer.stage import Stage

HAPPENING = frozenset((FAULTS, PLANT_EVENTS, EVENTS, CONTROLLER_EVENTS))
# Places of the tool that are drawn; beyond, every other one is left out.
MAX_PLACES = 1000
WAY_SECONDS = 0.5


class LiveViewer:
    """Shows the newest state of a run, what was desired of it, and the commands, each over the largest so far.

    Args:
        brief: of the run.
    """

    def __init__(self, brief: Brief) -> None:
        self._look = look_of(brief.urdf, brief.folders)
        self._tool = brief.tool or self._look.tool
        self._states, self._references = StateCodec(brief.joint_names), ReferenceCodec(brief.joint_names)
        self._commands, self._modes = CommandCodec(brief.joint_names), SupervisionCodec()
        self._exits = ExitStack()
        self._server = self._exits.enter_context(served(brief.view or 0))
        self._panel = LivePanel(self._server, brief)
        self.address = address_of(self._server)
        self._stage: Stage | None = None
        self._shown, self._mode = -1, ""
        self._largest = [1e-12, 1e-12]
        self._way, self._drawn = list[Vector](), monotonic()

    def say(self, topic: Topic, stamp: int, data: bytes) -> None:
        """Take what happens; the rest is looked up when it is drawn."""
        with suppress(SpaceRobotError):
            if topic in HAPPENING:
                self._panel.note(happened_at({topic.name: data}, stamp))
            elif topic is SUPERVISOR_MODE:
                self._mode = self._modes.decode(data).mode

    def draw(self, feed: Feed) -> None:
        """Show the newest state."""
        newest = feed.newest(BASE_ODOM)
        state = None if newest is None or newest[0] == self._shown else _joined(self._states, feed, newest[0])
        if state is None:
            return
        if state.stamp < self._shown:
            self._way.clear()
        self._shown = state.stamp
        if self._stage is None:
            self._stage = Stage(self._server, self._look, state.q, self._extended(state.q))
            self._panel.add_switches(self._stage.switches())
        self._stage.show(self._moment(state, feed))
        places = self._extended(state.q)
        if monotonic() - self._drawn > WAY_SECONDS:
            self._drawn = monotonic()
            self._stage.draw_way(places)
        self._panel.follow(state.stamp / NANOSECONDS, self._mode)

    def close(self) -> None:
        """Let go of the port."""
        self._exits.close()

    def _moment(self, state: RobotState, feed: Feed) -> Moment:
        desired = _joined(self._references, feed, state.stamp)
        # The answer to this state may not be there yet.
        known = feed.newest(self._commands.topics[0])
        command = None if known is None else _joined(self._commands, feed, known[0])
        joints = self._look.model.nv - 6
        torque, efforts = (np.zeros(3), np.zeros(joints)) if command is None else (command.wrench[3:], command.effort)
        return Moment(
            q=pin.normalize(self._look.model, state.q),
            q_d=pin.normalize(self._look.model, state.q if desired is None else desired.q),
            torque=self._share(0, torque),
            efforts=self._share(1, efforts),
        )

    def _share(self, index: int, values: Vector) -> Vector:
        self._largest[index] = max(self._largest[index], float(np.abs(values).max(initial=0.0)))
        return values / self._largest[index]

    def _extended(self, q: Vector) -> Vector:
        """The way of the tool so far, (K, 3) [m]."""
        self._way += list(way_of(self._look.model, q[np.newaxis], self._tool))
        if len(self._way) > MAX_PLACES:
            del self._way[1::2]
        return np.array(self._way)


def _joined(codec: PartsCodec[Any], feed: Feed, stamp: int) -> Any:
    """The value of a stamp [ns], if all its messages are there and fit."""
    parts = [feed.at(topic, stamp) for topic in codec.topics]
    if any(part is None for part in parts):
        return None
    try:
        return codec.decode([part for part in parts if part is not None])
    except SpaceRobotError:
        return None
