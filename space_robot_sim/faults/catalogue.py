"""All kinds of faults: for experiment files, the command line, ``list faults`` and docs/faults.md."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, get_args

from pydantic import BeforeValidator, Field

from space_robot_description.validation import nearest, parse_yaml_value, validate
from space_robot_msgs_py.errors import SpecError, shortened
from space_robot_sim.faults import base_actuators as base
from space_robot_sim.faults import body, joints, links, sensors
from space_robot_sim.faults.base import COMMON, Fault

MAX_KIND = 40
AnyFault = Annotated[
    joints.JointStuck
    | joints.JointEffectiveness
    | joints.JointOffset
    | joints.JointFriction
    | joints.JointFree
    | joints.JointRunaway
    | joints.JointBacklash
    | joints.JointLimitSwitch
    | joints.JointBrakeWeak
    | base.WheelStopped
    | base.WheelEffectiveness
    | base.WheelBias
    | base.WheelFriction
    | base.WheelLimit
    | base.ThrusterStuckOff
    | base.ThrusterStuckOn
    | base.ThrusterWeak
    | base.ThrusterLeaking
    | body.PayloadCaptured
    | body.PayloadLost
    | body.PayloadShifted
    | body.InertiaChange
    | body.WrenchPulse
    | sensors.SensorBias
    | sensors.SensorDrift
    | sensors.SensorNoise
    | sensors.SensorScale
    | sensors.SensorFrozen
    | sensors.SensorOutliers
    | sensors.SensorDelay
    | sensors.SensorSignFlip
    | sensors.SensorFrame
    | sensors.SensorDropout
    | sensors.SensorNan
    | links.LinkDrop
    | links.LinkDelay
    | links.LinkDuplicate
    | links.LinkReorder
    | links.LinkCorrupt
    | links.ControllerSilent
    | links.ControllerRestarted
    | links.GuidanceSilent,
    Field(discriminator="kind"),
    BeforeValidator(lambda data: _of_known_kind(data)),
]
_CLASSES: tuple[type[Fault], ...] = get_args(get_args(AnyFault)[0])
KINDS: dict[str, type[Fault]] = {cls.model_fields["kind"].default: cls for cls in _CLASSES}


@dataclass(frozen=True, slots=True)
class Key:
    """One key of a kind.

    Attributes:
        name: as typed.
        default: in JSON; empty: the key is required.
        meaning: with its unit.
    """

    name: str
    default: str
    meaning: str


def parse_fault(text: str) -> dict[str, Any]:
    """A fault as it is typed, ``joint_stuck joint=joint2 at=20``, as an experiment file would say it.

    Raises:
        SpecError: no kind, no such kind or key, or a value that cannot be used.
    """
    option = f"--fault {text!r}"
    kind, *assignments = _words(text, option) or [""]
    if kind not in KINDS:
        raise SpecError("no such kind of fault", key=option, value=kind, accepted=_kinds_like(kind))
    data: dict[str, Any] = {"kind": kind}
    for assignment in assignments:
        key, equals, value = assignment.partition("=")
        if not equals or key in data:
            accepted = "kind key=value ..., each key once"
            raise SpecError("not an assignment, or one too many", key=option, value=assignment, accepted=accepted)
        data[key] = parse_yaml_value(value, option)
    validate(KINDS[kind], data, option)
    return data


def keys_of(kind: str) -> list[Key]:
    """The keys of a kind besides those that all have, in the order of its class."""
    return list(_keys(KINDS[kind], lambda name: name not in COMMON))


def common_keys() -> list[Key]:
    """The keys that all kinds have."""
    return list(_keys(Fault, lambda name: name != "kind"))


def meaning(kind: str) -> str:
    """What happens, in one paragraph."""
    return " ".join((KINDS[kind].__doc__ or "").split())


def groups() -> dict[str, tuple[str, ...]]:
    """Kinds by group, in the order of the catalogue."""
    names = dict.fromkeys(cls.group for cls in _CLASSES)
    return {name: tuple(kind for kind, cls in KINDS.items() if cls.group == name) for name in names}


def _keys(cls: type[Fault], wanted: Callable[[str], bool]) -> Iterator[Key]:
    for name, info in cls.model_fields.items():
        key = info.alias or name
        if wanted(key):
            default = "" if info.is_required() else json.dumps(info.get_default(call_default_factory=True))
            yield Key(key, default, info.description or "a section, as `plant.payload`")


def _of_known_kind(data: Any) -> Any:
    """Pydantic's own message would list all kinds and show the whole fault."""
    kind = data.get("kind") if isinstance(data, Mapping) else getattr(data, "kind", None)
    if kind not in KINDS:
        raise ValueError(f"kind: no such fault as {shortened(repr(kind), MAX_KIND)}; {_kinds_like(kind)}")
    return data


def _kinds_like(kind: object) -> str:
    return nearest(kind, KINDS) or "one of `space-robot list faults`"


def _words(text: str, option: str) -> list[str]:
    """Split at spaces outside of quotes and brackets, which YAML needs for lists and sections."""
    words, depth, quote = [""], 0, ""
    for letter in text.strip():
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"":
            quote = letter
        else:
            depth += (letter in "[{") - (letter in "]}")
        if letter.isspace() and not depth and not quote:
            words.append("")
        else:
            words[-1] += letter
    if depth or quote:
        raise SpecError("a bracket or a quote is left open", key=option, accepted="kind key=value ...")
    return [word for word in words if word]
