"""Everything that is wrong with an experiment that cannot be composed, not only what is met first."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.controller import ControllerSpec
from space_robot_bringup.experiment.experiment import Experiment, Initial, NominalSpec
from space_robot_bringup.experiment.plant import PlantSpec
from space_robot_control.references.spec import HoldSpec
from space_robot_description.validation import with_others
from space_robot_msgs_py.errors import SpaceRobotError

# What every robot can do, in place of what is not looked at yet.
NEUTRAL: dict[str, Any] = {
    "initial": Initial(),
    "plant": PlantSpec(),
    "nominal": NominalSpec(),
    "reference": HoldSpec(kind="hold"),
    "controller": ControllerSpec(law="none"),
    "faults": (),
    "supervision": None,
    "settling_bands": {},
    "expect": {},
}
# A section is not looked at where one of these is wrong: it may only be wrong because of that.
NEEDS = {
    "reference": ("initial", "nominal"),
    "faults": ("plant",),
    "supervision": ("controller", "reference"),
    "expect": ("plant", "faults", "supervision"),
}


def diagnose(experiment: Experiment) -> Composition:
    """Compose an experiment, and if it cannot be, look at its sections one by one.

    Returns:
        The composition.

    Raises:
        SpaceRobotError: what was met first; its ``problems`` are all that was found.
    """
    try:
        return compose(experiment)
    except SpaceRobotError as first:
        found = {str(one): one for error in _problems(experiment) for one in error.problems or (error,)}
        raise with_others([*found.values()] or [first]) from None


def _problems(experiment: Experiment) -> Iterator[SpaceRobotError]:
    """What is wrong in each section, the ones before it being right."""
    sound, wrong = experiment.model_copy(update=NEUTRAL), set[str]()
    error = _error(sound)
    if error is not None:
        yield error
        return
    for name in NEUTRAL:
        if not wrong.isdisjoint(NEEDS.get(name, ())):
            continue
        for part in _parts(getattr(experiment, name)):
            larger = sound.model_copy(update={name: _joined(getattr(sound, name), part)})
            error = _error(larger)
            if error is None:
                sound = larger
            else:
                wrong.add(name)
                yield error


def _parts(value: Any) -> list[Any]:
    """A mapping entry by entry, a tuple item by item, all else as a whole."""
    if isinstance(value, dict):
        return [{key: one} for key, one in value.items()]
    return [(one,) for one in value] if isinstance(value, tuple) else [value]


def _joined(sound: Any, part: Any) -> Any:
    if isinstance(part, dict):
        return {**sound, **part}
    return (*sound, *part) if isinstance(part, tuple) else part


def _error(experiment: Experiment) -> SpaceRobotError | None:
    try:
        compose(experiment)
    except SpaceRobotError as error:
        return error
    return None
