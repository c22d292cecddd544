"""How a node of an experiment is started: from its command line and from ROS parameters, as one checked value."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from pydantic import Field, NonNegativeFloat

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.compose.parameters import overrides_from
from space_robot_bringup.experiment.experiment import Assignment, Experiment, load_experiment, parsed
from space_robot_bringup.modes.hooks import EFFORT_CONTROLLER, ROLES, STANDBY, SUPERVISOR
from space_robot_description.spec import Strict
from space_robot_description.validation import validate
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.version import __version__
from space_robot_sim.nodes.services import MAX_STEPS

EPILOG = """\
The same as ROS parameters, also from a file (--ros-args --params-file FILE): experiment, out, set, record, realtime,
autostart, law, gains.<name> and every other key of the experiment, for instance

  --ros-args -p law:=my_package.my_module:MyLaw -p gains.bandwidth:=0.4 -p duration:=20.0

`ros2 param list`, `describe` and `get` show all of a running node with units and ranges.
"""


IN_STANDBY = "controller.standby."


class Start(Strict):
    """What a node is started with."""

    experiment: str = Field(default="liu2023/fig08", description="shipped name or YAML file")
    out: str = Field(default="run", description="run directory, the recorder writes to it")
    overwrite: bool = Field(default=False, description="the recorder replaces a run that is in the run directory")
    set: tuple[str, ...] = Field(default=(), description="overrides key=value, the same at every node")
    record: bool = Field(default=True, description="a recorder takes part, and the simulator waits for it")
    realtime: NonNegativeFloat = Field(default=0.0, description="simulated seconds per second; 0: lock-step")
    step_count: int = Field(default=1, description="simulator: periods of one ~/step while paused", ge=1, le=MAX_STEPS)
    autostart: bool = Field(
        default=True, description="simulator and controller: configure and activate at once, or wait for ~/change_state"
    )
    failover: int = Field(
        default=0, description="paced: periods of silence after which a standby takes over; 0: there is none", ge=0
    )
    patience: NonNegativeFloat = Field(
        default=300.0, description="seconds to wait for a run to begin or to go on; 0, or without autostart: for ever"
    )


def parser(name: str = "") -> argparse.ArgumentParser:
    """The command line of a node.

    Args:
        name: of the executable that has its role already; without one the user says the role.
    """
    prog = name or "space_robot_bringup.nodes.process"
    made = argparse.ArgumentParser(
        prog=prog,
        description="One node of an experiment as one process.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    fields, nothing = Start.model_fields, argparse.SUPPRESS
    roles = (*ROLES, SUPERVISOR, STANDBY, EFFORT_CONTROLLER)
    made.add_argument("role", choices=roles, help=argparse.SUPPRESS if name else "which node")
    made.add_argument("--version", action="version", version=version_of(prog))
    default = f"; default {fields['experiment'].default}"
    made.add_argument("--experiment", default=nothing, help=f"{fields['experiment'].description}{default}")
    made.add_argument("--out", default=nothing, help=fields["out"].description)
    made.add_argument("--overwrite", action="store_true", default=nothing, help=fields["overwrite"].description)
    made.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="override one key; the same for every role"
    )
    made.add_argument(
        "--no-record", dest="record", action="store_false", default=nothing, help="no recorder takes part: await none"
    )
    made.add_argument("--realtime", type=float, default=nothing, help=fields["realtime"].description)
    made.add_argument("--failover", type=int, default=nothing, help=fields["failover"].description)
    made.add_argument("--patience", type=float, default=nothing, help=fields["patience"].description)
    made.add_argument("--debug", action="store_true", help="show the traceback of a law that fails")
    # Descriptors inherited from the process that starts the nodes of a run: orders and news, the locked run directory.
    made.add_argument("--tether", type=int, default=None, help=argparse.SUPPRESS)
    made.add_argument("--directory", type=int, default=None, help=argparse.SUPPRESS)
    return made


def version_of(name: str) -> str:
    """What ``--version`` of an executable says."""
    return f"{name} {__version__}"


def start_from(options: Mapping[str, Any], given: Mapping[str, Any]) -> Start:
    """Both sources together; the command line counts more.

    Args:
        options: of the command line, those that were given.
        given: ROS parameters, see ``given_at_start``.

    Raises:
        SpecError: a value is of the wrong kind.
    """
    own = {name: value for name, value in given.items() if name in Start.model_fields}
    if own.get("set") == "[]":
        # As a node shows it: ROS has no type for a list without items.
        own["set"] = []
    own |= {name: value for name, value in options.items() if name in Start.model_fields and name != "set"}
    overrides = [*_keys_in(given).values(), *validate(Start, own, "parameter").set, *options["set"]]
    return validate(Start, own | {"set": overrides}, "parameter")


def composed(
    start: Start, given: Mapping[str, Any], make: Callable[[Experiment], Composition] = compose
) -> Composition:
    """The run that a node takes part in; an error names the parameter that the user typed.

    Args:
        start: what the node is started with.
        given: ROS parameters, see ``given_at_start``.
        make: puts the run together.

    Raises:
        SpaceRobotError: the experiment is none.
    """
    listed = given.get("set", ())
    typed = dict.fromkeys(listed if isinstance(listed, list) else (), "parameter set")
    typed |= {text: f"parameter {name}" for name, text in _keys_in(given).items()}
    overrides: Sequence[Assignment] = [parsed(text, typed.get(text, "")) for text in start.set]
    try:
        overrides = _in_modes(start.experiment, overrides)
        return make(load_experiment(start.experiment, overrides))
    except SpaceRobotError as error:
        raise _as_typed(error, {one.key: one.where for one in overrides}) from None


def _in_modes(experiment: str, overrides: Sequence[Assignment]) -> Sequence[Assignment]:
    """Under supervision a controller shows the laws of modes as it shows those in standby elsewhere."""
    shown = [one for one in overrides if one.key.startswith(IN_STANDBY)]
    others = [one for one in overrides if one not in shown]
    if not shown or load_experiment(experiment, others).supervision is None:
        return overrides
    return [*others, *(one._replace(key=f"supervision.modes.{one.key.removeprefix(IN_STANDBY)}") for one in shown)]


def _keys_in(given: Mapping[str, Any]) -> dict[str, str]:
    """What is no start option is a key of the experiment, which refuses what it does not know."""
    return overrides_from({name: value for name, value in given.items() if name not in Start.model_fields})


def _as_typed(error: SpaceRobotError, typed: Mapping[str, str]) -> SpaceRobotError:
    """The error with the name that the user typed in place of the key of the experiment that it means."""
    for key in sorted(typed, key=len, reverse=True):
        before, found, rest = f" {error.key}".partition(f" {key}")
        if found and rest[:1] in ("", "."):
            named = f"{before.strip()} {typed[key]}{rest}".strip()
            return type(error)(error.message, key=named, value=error.value, accepted=error.accepted)
    return error


def split_ros_arguments(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Those of this project, and those from ``--ros-args`` on, which rclpy reads."""
    split = arguments.index("--ros-args") if "--ros-args" in arguments else len(arguments)
    return list(arguments[:split]), list(arguments[split:])
