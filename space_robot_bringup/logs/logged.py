"""What a log, or the directory of a campaign, says was run: data from elsewhere, which brings no code and no paths.

Whatever reads a log makes its experiment and its robot here. A law is only made where something is computed again, and
then only one that is installed or that the user typed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from space_robot_bringup.compose.composition import Composition, compose_world
from space_robot_bringup.experiment.controller import check_controller
from space_robot_bringup.experiment.experiment import Experiment, Overrides, assignments, experiment_from
from space_robot_control.laws.policy import INSTALLED, LawPolicy
from space_robot_description.share import shipped
from space_robot_description.validation import parse_yaml_text
from space_robot_msgs_py.errors import SpecError

_OUTSIDE = "names a file, which data from elsewhere may not"


def logged_experiment(text: str, where: str = "experiment.yaml") -> Experiment:
    """The experiment in a log.

    Args:
        text: the attachment.
        where: names it in errors.

    Raises:
        SpecError: it is none, or needs a file.
    """
    return experiment_from(confined(parse_yaml_text(text, where), where), where)


def compose_logged(experiment: Experiment, policy: LawPolicy = INSTALLED) -> Composition:
    """``compose`` for an experiment of a log: no law is made before ``controller()`` is called.

    Args:
        experiment: see ``logged_experiment``.
        policy: whose code may be its laws then.

    Raises:
        SpaceRobotError: it cannot be composed here.
    """
    return compose_world(experiment, policy)


def confined(data: Mapping[str, Any], where: str) -> dict[str, Any]:
    """The same experiment, which must need no file but shipped ones.

    A resolved experiment has its robot inside, with the URDF as text; one that names a file was written by hand.

    Raises:
        SpecError: it names a file of this machine.
    """
    robot = data.get("robot")
    urdf = robot.get("urdf") if isinstance(robot, Mapping) else ""
    if isinstance(urdf, str) and urdf and not urdf.lstrip().startswith("<"):
        raise SpecError(_OUTSIDE, key=f"{where} robot.urdf", value=urdf, accepted="URDF text")
    if isinstance(robot, str) and robot not in shipped("robots"):
        accepted = "a robot file's content, or the name of a shipped robot"
        raise SpecError(_OUTSIDE, key=f"{where} robot", value=robot, accepted=accepted)
    return dict(data)


def typed_in(overrides: Overrides) -> frozenset[str]:
    """Every text that the user typed as a value of an override: a law among them was typed by the user."""
    found: set[str] = set()
    for _, value, _ in assignments(overrides):
        _collect(value, found)
    return frozenset(found)


def law_policy(given: Iterable[str], laws: Mapping[str, str], *, allow_code: bool = False) -> LawPolicy:
    """What ``--law`` and ``--allow-code`` allow.

    Args:
        given: ``FILE:Class``, or ``NAME=FILE:Class`` with the name of a law in the experiment.
        laws: name in the experiment to the law it says.
        allow_code: everything the experiment names may be imported.

    Raises:
        SpecError: it is not clear which law is meant, or there is no such law.
    """
    named: dict[str, str] = {}
    custom = [name for name, law in laws.items() if ":" in law] or list(laws)
    for text in given:
        name, equals, law = text.partition("=")
        if not equals:
            if len(custom) != 1:
                accepted = f"NAME={text}, NAME one of {', '.join(custom)}"
                raise SpecError("could be one of several", key="--law", value=text, accepted=accepted)
            name, law = custom[0], text
        if name not in laws:
            raise SpecError("no such law in the experiment", key="--law", value=name, accepted=", ".join(laws))
        named[name] = law
    return LawPolicy(any_code=allow_code, given=named)


def with_laws(experiment: Experiment, policy: LawPolicy) -> Experiment:
    """The experiment with the laws the user typed in place of what it names, so that its log says what was run."""
    spec = experiment.controller
    standby = {name: one.model_copy(update={"law": policy.law(name, one.law)}) for name, one in spec.standby.items()}
    controller = spec.model_copy(update={"law": policy.law(spec.law, spec.law), "standby": standby})
    check_controller(controller, experiment.control_period)
    return experiment.model_copy(update={"controller": controller})


def _collect(value: Any, found: set[str]) -> None:
    if isinstance(value, str):
        found.add(value)
    elif isinstance(value, Mapping):
        for one in value.values():
            _collect(one, found)
    elif isinstance(value, list):
        for one in value:
            _collect(one, found)
