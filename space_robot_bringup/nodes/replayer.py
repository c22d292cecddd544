"""A bag on the live graph in place of the simulator: ``replay --publish`` and the executable ``replayer``."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from rclpy.clock import Clock
from rclpy.clock_type import ClockType

from space_robot_bringup.logs.foreign_bag import STARTS, Source
from space_robot_bringup.modes.context import domain_number, local_context
from space_robot_bringup.modes.graph import make_executor, raise_bug, spin
from space_robot_bringup.modes.signals import StopFlag
from space_robot_bringup.replay.comparison import EXACT
from space_robot_bringup.replay.publish import Answers, Broadcast, PublishOptions, open_broadcast
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_sim.nodes.replayer import ReplayerNode

ACKNOWLEDGE_SECONDS = 5.0
POLL_SECONDS = 0.05


def main(arguments: list[str] | None = None) -> int:
    """Publish one bag. Returns 0, 1 without an answer, 2 on bad input."""
    given = sys.argv[1:] if arguments is None else arguments
    split = given.index("--ros-args") if "--ros-args" in given else len(given)
    parser = argparse.ArgumentParser(prog="replayer", description=__doc__)
    parser.add_argument("bag", type=Path, help="run directory, bag or .mcap file, of any tool")
    parser.add_argument("--rate", type=float, default=None, help="recorded seconds per second; default lock-step")
    parser.add_argument("--paused", action="store_true", help="begin paused: ~/step, ~/pause")
    parser.add_argument("--loop", action="store_true", help="begin again after the last tick")
    parser.add_argument("--topics", nargs="+", default=(), help="only these topics")
    parser.add_argument("--as", dest="role", default="state", help="state: what a controller hears; all: commands too")
    parser.add_argument("--namespace", default="", help="of the topics in a bag of another tool")
    parser.add_argument(
        "--start", choices=STARTS, default=STARTS[0], help="what stamps count from: the run, or the first state"
    )
    own = parser.parse_args(given[:split])
    with StopFlag(signal.SIGINT, signal.SIGTERM) as stop:
        try:
            order = PublishOptions(own.role, tuple(own.topics), own.rate, own.paused, own.loop)
            broadcast = open_broadcast(own.bag, Source(own.namespace, own.start))
            reason = publish(broadcast, order, Answers(broadcast, EXACT), lambda: stop.reason, given[split:])
        except SpaceRobotError as error:
            print(f"replayer: {error}", file=sys.stderr)
            return 2
    return 0 if reason == "completed" or stop.reason is not None else 1


def publish(
    broadcast: Broadcast,
    order: PublishOptions,
    answers: Answers,
    stop: Callable[[], str | None],
    ros_arguments: Sequence[str] = (),
) -> str:
    """Publish a bag until it is over, the run is ended or ``stop`` gives a reason; returns the reason.

    Nodes that are to hear it are on the domain of ROS_DOMAIN_ID, as with every ROS process.
    """
    domain = domain_number(os.environ.get("ROS_DOMAIN_ID", "0"))
    with local_context(domain, ros_arguments) as context:
        node = ReplayerNode(
            broadcast.ticks,
            broadcast.joint_names,
            topics=order.published,
            urdf=broadcast.urdf,
            period=broadcast.period,
            rate=order.pace,
            paused=order.paused,
            loop=order.loop,
            on_answer=answers.take,
            context=context,
        )
        executor = make_executor(context)
        executor.add_node(node)

        def poll() -> None:
            if (reason := stop()) is not None:
                node.end(reason)

        # A timer, because the executor comes back from a spin only when it has nothing to do.
        node.create_timer(POLL_SECONDS, poll, clock=Clock(clock_type=ClockType.STEADY_TIME))
        while node.end_reason is None:
            spin(executor, node)
        node.flush(ACKNOWLEDGE_SECONDS)
        executor.shutdown()
        node.destroy_node()
        raise_bug(node)
        return node.end_reason


if __name__ == "__main__":
    sys.exit(main())
