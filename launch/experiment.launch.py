"""``ros2 launch space_robot_bringup experiment.launch.py experiment:=liu2023/fig08 controller:=ntsmc realtime:=1.0``.

The nodes of ``space-robot run --mode processes``, started by ROS launch. Every node ends with the run. When one fails,
the others end too, the recorder closes its log, and launch exits with 1.
"""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

from launch.actions import DeclareLaunchArgument, OpaqueFunction, RegisterEventHandler, TimerAction
from launch.conditions import evaluate_condition_expression
from launch.event import Event
from launch.event_handlers import OnProcessExit
from launch.events.process import ProcessExited
from launch.substitutions import TextSubstitution
from launch_ros.actions import Node

from launch import LaunchContext, LaunchDescription
from space_robot_bringup.launching import check_experiment, refuse_unknown_arguments

PACKAGES = {
    "recorder": "space_robot_sim",
    "guidance": "space_robot_control",
    "controller": "space_robot_control",
    "simulator": "space_robot_sim",
}
SUPERVISOR = {"supervisor": "space_robot_supervisor"}
# In place of the controller, where it is asked for.
EFFORTS = {"effort_controller": "space_robot_control"}
# Instead of a table: that of the experiment.
OWN = "own"
# Instead of a law: a node of another project commands.
EXTERNAL = "external"
ALL_NODES = " ".join(PACKAGES)
ARGUMENTS = {
    "experiment": (None, "shipped name or YAML file"),
    "controller": ("", "law to run it with, or external: a custom node; default: the experiment's"),
    "supervision": (
        "",
        "table for a supervisor: shipped name or file, or `own`: the experiment's; default: no such node",
    ),
    "record": ("true", "whether a recorder takes part and keeps a log"),
    "out": ("", "run directory; default: runs/ and the name of the experiment"),
    "overwrite": ("false", "whether the recorder replaces a run that is in the run directory"),
    "realtime": ("", "simulated seconds per second; default: lock-step, as fast as it goes"),
    "namespace": ("", "of all nodes and topics, one for each robot on a domain"),
    "set": ("", "further keys of the experiment, 'key=value key=value'"),
    "nodes": (ALL_NODES, "which to start here, where a graph is spread over machines"),
}
# A node that fails says why before it ends; the recorder needs a moment to hear and to write it.
HEARING_SECONDS = 3.0


def generate_launch_description() -> LaunchDescription:
    """Arguments and nodes."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=text)
        for name, (default, text) in ARGUMENTS.items()
    ]
    return LaunchDescription(
        [*declared, OpaqueFunction(function=_nodes), RegisterEventHandler(OnProcessExit(on_exit=_on_exit))]
    )


def _nodes(context: LaunchContext) -> list[Node]:
    chosen = context.launch_configurations
    recorded, overwrite = (
        evaluate_condition_expression(context, [TextSubstitution(text=chosen[name])])
        for name in ("record", "overwrite")
    )
    overrides = _overrides(chosen)
    # Once, in place of once by every node.
    refuse_unknown_arguments(Path(__file__).name, ARGUMENTS, context.argv or (), sys.argv)
    check_experiment(chosen["experiment"], overrides)
    options = _options(chosen, overrides, recorded=recorded, overwrite=overwrite)
    roles = chosen["nodes"].split()
    packages = PACKAGES | SUPERVISOR | EFFORTS
    if chosen["controller"] == EXTERNAL and chosen["nodes"] == ALL_NODES:
        roles.remove("controller")
    if chosen["supervision"] and chosen["nodes"] == ALL_NODES:
        roles.append("supervisor")
    if unknown := sorted(set(roles) - set(packages)):
        raise ValueError(f"nodes: no such node; got {', '.join(unknown)}; accepted: {', '.join(packages)}")
    return [
        Node(
            package=packages[role],
            executable=role,
            namespace=chosen["namespace"],
            arguments=options,
            output="screen",
        )
        for role in roles
        if recorded or role != "recorder"
    ]


def _options(chosen: dict[str, str], overrides: list[str], *, recorded: bool, overwrite: bool) -> list[str]:
    """The command line that all nodes share: one experiment for every node."""
    experiment = Path(chosen["experiment"])
    # A shipped one by its full name, so that two of one name in two folders do not meet.
    name = experiment.stem if experiment.suffix in (".yaml", ".yml") else experiment
    options = ["--experiment", chosen["experiment"], "--out", chosen["out"] or str(Path("runs") / name)]
    if overwrite:
        options.append("--overwrite")
    if not recorded:
        options.append("--no-record")
    if chosen["realtime"]:
        options += ["--realtime", chosen["realtime"]]
    for override in overrides:
        options += ["--set", override]
    return options


def _overrides(chosen: dict[str, str]) -> list[str]:
    """Keys of the experiment that arguments set."""
    law = [f"controller.law={chosen['controller']}"] if chosen["controller"] else []
    if chosen["supervision"] not in ("", OWN):
        law.append(f"supervision={chosen['supervision']}")
    return [*law, *shlex.split(chosen["set"])]


def _on_exit(event: Event, context: LaunchContext) -> TimerAction | None:
    if not isinstance(event, ProcessExited) or not event.returncode or context.is_shutdown:
        return None

    def fail(context: LaunchContext) -> None:
        # Launch exits with 1 only when something raises; a Shutdown event leaves its exit code 0. Who fails later
        # fails because of the first.
        if not context.is_shutdown:
            raise RuntimeError(f"{event.process_name} failed with exit code {event.returncode}")

    return TimerAction(period=HEARING_SECONDS, actions=[OpaqueFunction(function=fail)], cancel_on_shutdown=False)
