"""``ros2 launch space_robot_bringup replay.launch.py bag:=runs/fig08 [rate:=1.0] [experiment:=liu2023/fig08]``.

The replayer speaks in place of the simulator and guidance; a controller on the graph answers. With ``experiment`` that
is a shipped one. Launch exits with 1 when a node fails or no command comes.
"""

from __future__ import annotations

import sys
from pathlib import Path

from launch.actions import DeclareLaunchArgument, OpaqueFunction, RegisterEventHandler
from launch.conditions import evaluate_condition_expression
from launch.event import Event
from launch.event_handlers import OnProcessExit
from launch.events.process import ProcessExited
from launch.substitutions import TextSubstitution
from launch_ros.actions import Node

from launch import LaunchContext, LaunchDescription
from space_robot_bringup.launching import refuse_unknown_arguments

ARGUMENTS = {
    "bag": (None, "run directory, bag or .mcap file, of any tool"),
    "rate": ("", "recorded seconds per second; default: lock-step, the next tick when the last one is answered"),
    "as": ("state", "what to publish, state: what a controller hears; all: commands too"),
    "paused": ("false", "begin paused: ~/step, ~/pause"),
    "loop": ("false", "begin again after the last tick"),
    "bag_namespace": ("", "in front of the topics in a bag of another tool"),
    "start": ("run", "what stamps in such a bag count from: run, or first, its first state"),
    "experiment": ("", "of a controller that answers, shipped name or YAML file; default: none is started"),
    "controller": ("", "its law; default: the one of the experiment"),
    "namespace": ("", "of all nodes and topics"),
}


def generate_launch_description() -> LaunchDescription:
    """Arguments, the replayer and perhaps a controller."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=text)
        for name, (default, text) in ARGUMENTS.items()
    ]
    return LaunchDescription(
        [*declared, OpaqueFunction(function=_nodes), RegisterEventHandler(OnProcessExit(on_exit=_on_exit))]
    )


def _nodes(context: LaunchContext) -> list[Node]:
    chosen = context.launch_configurations
    refuse_unknown_arguments(Path(__file__).name, ARGUMENTS, context.argv or (), sys.argv)
    options = [chosen["bag"], "--as", chosen["as"], "--start", chosen["start"]]
    for name, option in (("rate", "--rate"), ("bag_namespace", "--namespace")):
        if chosen[name]:
            options += [option, chosen[name]]
    for flag in ("paused", "loop"):
        if evaluate_condition_expression(context, [TextSubstitution(text=chosen[flag])]):
            options.append(f"--{flag}")
    nodes = [_node("space_robot_sim", "replayer", options, chosen)]
    if chosen["experiment"]:
        law = ["--set", f"controller.law={chosen['controller']}"] if chosen["controller"] else []
        nodes.append(_node("space_robot_control", "controller", ["--experiment", chosen["experiment"], *law], chosen))
    return nodes


def _node(package: str, executable: str, options: list[str], chosen: dict[str, str]) -> Node:
    return Node(
        package=package, executable=executable, namespace=chosen["namespace"], arguments=options, output="screen"
    )


def _on_exit(event: Event, context: LaunchContext) -> None:
    # Launch exits with 1 only when something raises; a Shutdown event leaves its exit code 0.
    if isinstance(event, ProcessExited) and event.returncode and not context.is_shutdown:
        raise RuntimeError(f"{event.process_name} failed with exit code {event.returncode}")
