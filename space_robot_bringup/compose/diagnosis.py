"""Everything that is wrong with an experiment that cannot be composed, not only what is met first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.compose.controllers import gains_problems
from space_robot_bringup.experiment.controller import ControllerSpec, check_controller
from space_robot_bringup.experiment.experiment import Experiment, Initial, NominalSpec, experiment_from
from space_robot_bringup.experiment.plant import PlantSpec
from space_robot_control.references.spec import HoldSpec
from space_robot_description.validation import with_others
from space_robot_msgs_py.errors import SpaceRobotError

# What every robot can do, in place of what is not looked at yet; made when it is needed, which takes its time.
NEUTRAL: dict[str, Callable[[], Any]] = {
    "initial": Initial,
    "plant": PlantSpec,
    "nominal": NominalSpec,
    "reference": lambda: HoldSpec(kind="hold"),
    "controller": lambda: ControllerSpec(law="none"),
    "faults": tuple,
    "supervision": lambda: None,
    "settling_bands": dict,
    "expect": dict,
}
# Control period and duration: what has times in it is right or wrong by them.
TIMES = "times"
# The smallest experiment; it has no robot.
SMALLEST: dict[str, Any] = {"robot": "", "control_period": 1.0, "duration": 1.0, "reference": {"kind": "hold"}}
# A section is not looked at where one of these is wrong: it may only be wrong because of that.
NEEDS = {
    "plant": (TIMES,),
    "reference": ("initial", "nominal", TIMES),
    "controller": (TIMES,),
    "faults": ("plant", TIMES),
    "supervision": ("controller", "reference", TIMES),
    "expect": ("plant", "faults", "supervision", TIMES),
}


def diagnosed(data: Mapping[str, Any], where: str) -> Composition:
    """Check a mapping as an experiment and compose it; what is wrong in one section hides nothing in another.

    Args:
        data: see ``experiment_from``.
        where: names it in errors.

    Returns:
        The composition.

    Raises:
        SpaceRobotError: what was met first; its ``problems`` are all that was found.
    """
    try:
        experiment = experiment_from(data, where)
    except SpaceRobotError as first:
        raise all_of([first, *_in_the_rest(data)]) from None
    return diagnose(experiment)


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
        raise all_of([*_problems(experiment, set())] or [first]) from None


def all_of(errors: Sequence[SpaceRobotError]) -> SpaceRobotError:
    """One error of some, each of which may be several; what two of them say is said once."""
    return with_others([*{str(one): one for error in errors for one in error.problems or (error,)}.values()])


def _in_the_rest(data: Mapping[str, Any]) -> Iterator[SpaceRobotError]:
    """What is wrong in the sections, and their entries, that are written as they should be."""
    kept, wrong = _written_well(data)
    if "robot" not in kept:
        return
    # A wrong section counts as what every robot can do, which is not always its default.
    experiment = Experiment.model_validate(SMALLEST | kept).model_copy(
        update={name: neutral() for name, neutral in NEUTRAL.items() if name in wrong and name not in kept}
    )
    if TIMES not in wrong:
        try:
            _ = experiment.steps
            check_controller(experiment.controller, experiment.control_period)
        except SpaceRobotError as error:
            yield error
            wrong.add(TIMES)
    if TIMES in wrong:
        experiment = experiment.model_copy(update={key: SMALLEST[key] for key in ("control_period", "duration")})
        yield from gains_problems(experiment.controller)
    yield from _problems(experiment, wrong)


def _written_well(data: Mapping[str, Any]) -> tuple[dict[str, Any], set[str]]:
    """What of the data fits the schema, and what does not: sections, and `TIMES` for the time base."""
    kept, wrong = dict[str, Any](), set[str]()
    for key, value in data.items():
        if _fits(key, value):
            kept[key] = value
        elif key not in Experiment.model_fields:
            # Misspelt: what was meant is not there.
            wrong.update(get_close_matches(key, NEUTRAL, n=1))
        elif key in NEUTRAL:
            wrong.add(key)
            part = _part_that_fits(key, value)
            if _fits(key, part):
                kept[key] = part
    if not {"control_period", "duration"} <= set(kept):
        wrong.add(TIMES)
    return kept, wrong


def _part_that_fits(key: str, value: Any) -> Any:
    """The entries of a section that are right by themselves."""
    if isinstance(value, list):
        return [one for one in value if _fits(key, [one])]
    if isinstance(value, dict):
        kind = {"kind": value["kind"]} if "kind" in value else {}
        return {name: one for name, one in value.items() if _fits(key, kind | {name: one})}
    return None


def _fits(key: str, value: Any) -> bool:
    try:
        Experiment.model_validate(SMALLEST | {key: value})
    except ValidationError:
        return False
    return True


def _problems(experiment: Experiment, wrong: set[str]) -> Iterator[SpaceRobotError]:
    """What is wrong in each section, the ones before it being right; ``wrong`` are those that are known to be not."""
    sound = experiment.model_copy(update={name: neutral() for name, neutral in NEUTRAL.items()})
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
