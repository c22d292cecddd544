"""Whether custom laws forget: the same states after a reset, or to a new law, have to get the same answers."""

from __future__ import annotations

import numpy as np

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.compose.controllers import make_controller
from space_robot_control.laws.base import Law
from space_robot_control.laws.guarded import guarded_update
from space_robot_control.laws.registry import BUILT_IN
from space_robot_description.rotations import from_rpy
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import Reference, RobotState

PERIODS = 5
# How far the states are from the initial one [rad or m], and how fast [rad/s or m/s], times 1, 2, 3, ...
OFF, RATE = 0.01, 0.002
Answer = dict[str, bytes]


def what_is_not_forgotten(composition: Composition) -> str:
    """A warning about a custom law that carries something from one run into the next; empty where none does.

    Two laws are made and one of them is reset; each is given a few made-up states near the initial one.

    Args:
        composition: of an experiment that the user runs; code of its laws is executed.
    """
    spec, period = composition.experiment.controller, composition.experiment.control_period
    if set(spec.law_names) <= BUILT_IN.keys():
        return ""
    first, second = (make_controller(spec, composition.nominal, period, composition.policy) for _ in range(2))
    states = _states(composition)
    try:
        wanted = _answers(first, states)
    except SpaceRobotError:
        # A law that cannot go on here says so in a run, too.
        return ""
    for law, when in ((first, "after a reset"), (second, "in a second law")):
        try:
            again = _answers(law, states)
        except SpaceRobotError as error:
            return _said(spec.law, f"{when} the same states end with: {error}")
        for tick, (one, other) in enumerate(zip(wanted, again, strict=True)):
            if different := [name for name in one.keys() | other.keys() if one.get(name) != other.get(name)]:
                names = ", ".join(sorted(different))
                return _said(spec.law, f"{when} the same states get other answers (tick {tick}: {names})")
    return ""


def _said(law: str, what: str) -> str:
    return f"{law} does not forget: {what}; what compute() changes has to be set in reset(), and not on the class"


def _states(composition: Composition) -> list[tuple[RobotState, Reference]]:
    (q0, v0), source, n = composition.initial, composition.reference(), composition.nominal.n
    pairs = []
    for tick in range(PERIODS):
        stamp, size = tick * composition.experiment.period, float(tick + 1)
        q, v = q0.copy(), v0 + RATE * size
        q[3:7] = from_rpy(np.full(3, OFF * size))
        q[7:] += OFF * size
        pairs.append((RobotState(stamp, q, v, np.zeros(n), np.zeros(3)), source.at(stamp)))
    return pairs


def _answers(law: Law, states: list[tuple[RobotState, Reference]]) -> list[Answer]:
    law.reset()
    return [_answer(law, *pair, tick) for tick, pair in enumerate(states)]


def _answer(law: Law, state: RobotState, reference: Reference, tick: int) -> Answer:
    output = guarded_update(law, state, reference, tick)
    telemetry = output.telemetry
    edges = np.cumsum((0, *telemetry.sizes))
    blocks = {
        name: telemetry.data[begin:end].tobytes()
        for name, begin, end in zip(telemetry.labels, edges, edges[1:], strict=False)
    }
    return {"command": output.command.u.tobytes(), **blocks}
