"""One node of an experiment as one process: what ``--mode processes`` starts.

python -m space_robot_bringup.nodes.process simulator --experiment liu2023/fig08 --out runs/fig08
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from time import monotonic

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.context import Context

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.context import domain_number, local_context
from space_robot_bringup.modes.graph import drain, make_executor, make_node, raise_bug, spin
from space_robot_bringup.modes.signals import StopFlag
from space_robot_bringup.nodes.arguments import Start, parser, split_ros_arguments, start_from
from space_robot_description.fields import parameter_rows
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.managed import bring_up
from space_robot_msgs_py.nodes.parameters import given_at_start
from space_robot_sim.nodes.pacing import REALTIME
from space_robot_sim.nodes.recorder import RecorderNode

ACKNOWLEDGE_SECONDS = 5.0
PROGRESS_SECONDS = 0.2
POLL_SECONDS = 0.05


def main(arguments: list[str] | None = None) -> int:
    """Run one node until the run ends. Returns 0, 1 where the node failed, 2 on bad input."""
    own, ros = split_ros_arguments(sys.argv[1:] if arguments is None else arguments)
    options = parser().parse_args(own)
    with StopFlag(signal.SIGINT, signal.SIGTERM) as stop:
        try:
            # As every ROS process: nodes started together are given one domain, or they meet on 0.
            domain = domain_number(os.environ.get("ROS_DOMAIN_ID", "0"))
            with local_context(domain, ros) as context:
                start = start_from(vars(options), given_at_start(options.role, context))
                composition = compose(load_experiment(start.experiment, start.set))
                node = _node(options.role, start, composition, context)
                progress = _printer(composition.experiment.period) if options.progress else None
                return _spin(node, stop, progress)
        except SpaceRobotError as error:
            print(f"space-robot {options.role}: {error}", file=sys.stderr)
            return 2


def _node(role: str, start: Start, composition: Composition, context: Context) -> GraphNode:
    node = make_node(
        role,
        composition,
        Path(start.out),
        realtime=start.realtime or None,
        mode="processes",
        context=context,
        # The simulator's own is the one that may change in flight.
        rows=[row for row in parameter_rows(start) if row.name != REALTIME or role != "simulator"],
        overridable=True,
        **({} if role != "simulator" else {"recorded": start.record}),
    )
    if start.autostart:
        bring_up([node])
    return node


def _spin(node: GraphNode, stop: StopFlag, progress: Callable[[GraphNode], None] | None) -> int:
    executor = make_executor(node.context)
    executor.add_node(node)

    def poll() -> None:
        if stop.reason is not None:
            node.end(stop.reason)
        if progress is not None:
            progress(node)

    # A timer, because the executor comes back from a spin only when it has nothing to do.
    node.create_timer(POLL_SECONDS, poll, clock=Clock(clock_type=ClockType.STEADY_TIME))
    while node.end_reason is None:
        spin(executor, node)
    if isinstance(node, RecorderNode):
        drain(executor, node, node.end_reason)
    node.flush(ACKNOWLEDGE_SECONDS)
    node.destroy_node()
    raise_bug(node)
    return 0 if node.failure is None else 1


def _printer(period: int) -> Callable[[GraphNode], None]:
    shown = -1.0

    def show(node: GraphNode) -> None:
        nonlocal shown
        if isinstance(node, RecorderNode) and monotonic() - shown > PROGRESS_SECONDS:
            shown = monotonic()
            print(f"tick {node.written_until // period}", flush=True)

    return show


if __name__ == "__main__":
    sys.exit(main())
