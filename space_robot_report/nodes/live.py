"""The process beside a run that shows it: ``python -m space_robot_report.nodes.live``, started by ``run --view``.

Its first line of input is a ``Brief``, its only line of output says where the run is shown, or why it cannot be. It
ends when its input does, which is when the run is over or the process that started it is gone.
"""

from __future__ import annotations

import json
import os
import select
import sys
from contextlib import ExitStack, closing
from typing import Any, Protocol, TextIO

from space_robot_bringup.modes.context import domain_number, local_context
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.topics import Topic
from space_robot_report.live.brief import Brief
from space_robot_report.live.feed import Feed
from space_robot_report.nodes.listener import Listener

FRAME_SECONDS = 1.0 / 30.0
# The run goes first.
NICE = 19


class Screen(Protocol):
    """What shows a run."""

    address: str

    def say(self, topic: Topic, stamp: int, data: bytes) -> None:
        """Take a message with its stamp [ns]."""

    def draw(self, feed: Feed) -> None:
        """Show what is known now."""


def main() -> int:
    """Show a run until the input ends."""
    os.nice(NICE)
    # What a library prints is no news: the middleware has been seen to.
    news = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    brief = Brief.of_line(sys.stdin.readline())
    feed = Feed(brief)
    with ExitStack() as stack:
        try:
            screens = {name: stack.enter_context(closing(one)) for name, one in _screens(brief, feed).items()}
        except SpaceRobotError as error:
            _say(news, {"error": str(error)})
            return 2
        context = stack.enter_context(local_context(domain_number(os.environ["ROS_DOMAIN_ID"])))
        listener = stack.enter_context(closing(Listener(context, feed.topics)))
        _say(news, {name: screen.address for name, screen in screens.items()})
        while True:
            over = bool(select.select([sys.stdin], [], [], FRAME_SECONDS)[0])
            _show(listener, feed, list(screens.values()))
            if over:
                return 0


def _screens(brief: Brief, feed: Feed) -> dict[str, Any]:
    screens: dict[str, Any] = {}
    # Only what is asked for has to be installed.
    if brief.view is not None:
        from space_robot_report.viewer.live import LiveViewer

        screens["view"] = LiveViewer(brief)
    if brief.foxglove is not None:
        from space_robot_report.live.bridge import FoxgloveBridge

        screens["foxglove"] = FoxgloveBridge(brief, feed.static)
    return screens


def _show(listener: Listener, feed: Feed, screens: list[Screen]) -> None:
    for topic, raw in listener.take():
        for message in feed.read(topic, raw):
            for screen in screens:
                screen.say(*message)
    for screen in screens:
        screen.draw(feed)


def _say(stream: TextIO, news: dict[str, str]) -> None:
    print(json.dumps(news), file=stream, flush=True)


if __name__ == "__main__":
    sys.exit(main())
