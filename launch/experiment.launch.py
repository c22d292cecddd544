"""``ros2 launch space_robot experiment.launch.py experiment:=liu2023/fig08 out:=runs/fig08 [realtime:=1.0]``.

The nodes of ``space-robot run --mode processes``, started by ROS launch. Every node ends with the run; when one fails,
the others are shut down and the recorder closes its log.
"""

from __future__ import annotations

import sys

from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction, RegisterEventHandler, Shutdown
from launch.event import Event
from launch.event_handlers import OnProcessExit
from launch.events.process import ProcessExited

from launch import LaunchContext, LaunchDescription

ROLES = ("recorder", "guidance", "controller", "simulator")


def generate_launch_description() -> LaunchDescription:
    """Arguments and the four nodes."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("experiment", description="shipped name or YAML file"),
            DeclareLaunchArgument("out", description="run directory"),
            DeclareLaunchArgument("realtime", default_value="", description="simulated seconds per second"),
            OpaqueFunction(function=_nodes),
        ]
    )


def _nodes(context: LaunchContext) -> list[ExecuteProcess | RegisterEventHandler]:
    arguments = context.launch_configurations
    options = ["--experiment", arguments["experiment"], "--out", arguments["out"]]
    if arguments["realtime"]:
        options += ["--realtime", arguments["realtime"]]
    module = [sys.executable, "-m", "space_robot_bringup.nodes.process"]
    processes = [ExecuteProcess(cmd=[*module, role, *options], name=role, output="screen") for role in ROLES]
    return [*processes, RegisterEventHandler(OnProcessExit(on_exit=_on_exit))]


def _on_exit(event: Event, context: LaunchContext) -> Shutdown | None:
    if isinstance(event, ProcessExited) and event.returncode:
        return Shutdown(reason=f"{event.process_name} failed")
    return None
