"""The experiment as parameters: what each node shows of it, and what it was given at the start in its place."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_description.fields import parameter_rows
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.parameters import ParameterRow, is_not_shown, not_shown

# What a node calls shorter than the experiment does.
CONTROLLER = ("law", "gains", "standby", "switches", "handover")
# Where a run has got to, which is nothing to start with.
ACTIVE_LAW = "active_law"
# The one text that may be any, and so is no YAML.
TITLE = "title"


def rows_of(role: str, composition: Composition) -> list[ParameterRow]:
    """The part of the resolved experiment that concerns a node, all of it read-only.

    Gains are the law's own: they are declared when it is there.
    """
    experiment = composition.experiment
    robot = experiment.robot if isinstance(experiment.robot, str) else not_shown(composition.nominal.name)
    rows = [ParameterRow("robot", robot, "shipped name or file of the robot"), *_plain(experiment)]
    if role in ("controller", "standby"):
        rows += [row for row in parameter_rows(experiment.controller) if not row.name.startswith(("gains", "standby"))]
        rows += parameter_rows(experiment.nominal, "nominal.")
    elif role == "supervisor" and experiment.supervision is not None:
        rows += parameter_rows(experiment.supervision, "supervision.")
    elif role == "guidance":
        rows += parameter_rows(experiment.reference, "reference.")
    elif role == "simulator":
        rows += [*parameter_rows(experiment.initial, "initial."), *parameter_rows(experiment.plant, "plant.")]
    return rows


def overrides_from(given: Mapping[str, Any]) -> dict[str, str]:
    """Parameters given at the start as ``--set`` takes them: ``law`` and ``gains.kappa`` are the controller's.

    Args:
        given: name to plain value; a text may be YAML, as on the command line. Of what ``ros2 param dump`` writes
            the active law is left out, and where a value is too long to be shown: it is that of the experiment.

    Returns:
        ``key=value`` by the name of the parameter.

    Raises:
        SpecError: a parameter without a value.
    """
    found = {}
    for name, value in given.items():
        if value is None:
            raise SpecError("has no value", key=f"parameter {name}")
        if is_not_shown(value) or name == ACTIVE_LAW:
            continue
        key = f"controller.{name}" if name.partition(".")[0] in CONTROLLER else name
        literal = isinstance(value, str) and name != TITLE
        found[name] = f"{key}={value if literal else json.dumps(value)}"
    return found


def _plain(experiment: Experiment) -> list[ParameterRow]:
    wanted = (TITLE, "control_period", "duration", "seed")
    return [row for row in parameter_rows(experiment.model_copy(update={"robot": ""})) if row.name in wanted]
