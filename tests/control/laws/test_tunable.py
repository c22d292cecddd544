"""Gains changed during the run: from the next update on, reported with it, refused as a whole, repeated to the bit."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_control.laws.base import Law
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, ControlOutput, Reference, RobotState

CHANGES: dict[str, dict[str, Any]] = {
    "computed_torque": {"gains.bandwidth.rotation": 0.3, "gains.damping": 0.8},
    "pd": {"gains.bandwidth": 0.2},
    "adaptive": {"gains.lambda.joints": 0.4, "gains.kappa": 0.7},
    "ntsmc": {"gains.k1": 0.02, "gains.gamma.rotation": [0.1, 0.2, 0.1], "gains.boundary_layer": 0.002},
    "ntsmc_euler": {"gains.k2.joints": {"joint1": 0.05}},
    "mfac": {"gains.kappa": 3.0, "gains.rho": 0.02},
}
PERIOD = NANOSECONDS // 4


def law(name: str, gains: dict[str, Any] | None = None) -> Law:
    """A law on the robot `mini`."""
    overrides = [f"controller.law={name}", f"controller.gains={json.dumps(gains or {})}"]
    return compose(load_experiment("compare/mini", overrides)).controller()


def walk(count: int) -> list[tuple[RobotState, Reference]]:
    """States and references of an aimless run."""
    rng, pairs = np.random.default_rng(3), []
    q, v = np.zeros(11), np.zeros(10)
    q[6] = 1.0
    for tick in range(count):
        v = v + rng.normal(scale=1e-3, size=10)
        q = q + np.concatenate([np.zeros(7), 0.25 * v[6:]])
        asked = q + np.concatenate([np.zeros(3), [0.01, 0.0, 0.0, 0.0], np.full(4, 0.02)])
        asked[3:7] /= np.linalg.norm(asked[3:7])
        state = RobotState(tick * PERIOD, q, v, np.zeros(4), np.zeros(3))
        pairs.append((state, Reference(tick * PERIOD, asked, 0.9 * v, 0.1 * v)))
    return pairs


def outputs_of(subject: Law, change_at: dict[int, dict[str, Any]], count: int = 12) -> list[ControlOutput]:
    """The answers to a walk, with changes before some of the updates."""
    subject.reset()
    outputs = []
    for tick, (state, reference) in enumerate(walk(count)):
        if tick in change_at:
            subject.tune(change_at[tick])
        outputs.append(subject.update(state, reference))
    return outputs


@pytest.mark.parametrize("name", CHANGES)
def test_a_gain_change_acts_from_the_next_update_and_is_its_event(name: str) -> None:
    """Commands before the change are those of an untouched law, the one after differs and carries the event."""
    plain, tuned = outputs_of(law(name), {}), outputs_of(law(name), {6: CHANGES[name]})
    same = [a.command.u.tobytes() == b.command.u.tobytes() for a, b in zip(plain, tuned, strict=True)]
    assert all(same[:6])
    assert not same[6]
    reported = [(index, event) for index, output in enumerate(tuned) for event in output.events]
    assert [(index, event.stamp, event.kind) for index, event in reported] == [(6, 6 * PERIOD, "parameters")]
    assert reported[0][1].content == {"values": CHANGES[name]}


@pytest.mark.parametrize("name", CHANGES)
def test_the_events_of_a_run_repeat_it(name: str) -> None:
    """Tuning a fresh law by the events of a run gives its commands and events again, bit for bit."""
    first = outputs_of(law(name), {4: CHANGES[name]})
    events = {index: dict(event.content["values"]) for index, output in enumerate(first) for event in output.events}
    again = outputs_of(law(name), events)
    assert [o.command.u.tobytes() for o in again] == [o.command.u.tobytes() for o in first]
    assert [o.events for o in again] == [o.events for o in first]


@pytest.mark.parametrize("name", CHANGES)
def test_gains_survive_a_reset_and_are_reported_again(name: str) -> None:
    """After a reset the law runs as one built with the changed gains, and the first output says so."""
    tuned = law(name)
    outputs_of(tuned, {3: CHANGES[name]})
    again = outputs_of(tuned, {})
    built = outputs_of(law(name, tuned.gains.model_dump(mode="json", by_alias=True)), {})
    assert [o.command.u.tobytes() for o in again] == [o.command.u.tobytes() for o in built]
    assert [event.content for event in again[0].events] == [{"values": CHANGES[name]}]


@pytest.mark.parametrize(
    ("name", "changes", "why"),
    [
        ("computed_torque", {"gains.bandwidth.joints": 9.0}, "unstable when sampled"),
        ("computed_torque", {"gains.damping": 0.9, "gains.bandwidth.joints": -1.0}, "greater than or equal to 0"),
        ("computed_torque", {"gains.damping": float("nan")}, "finite number"),
        ("computed_torque", {"gains.allow_unstable": True}, "cannot change during the run"),
        ("computed_torque", {"gains.dampin": 1.0}, "accepted: gains.damping|accepted: damping"),
        ("computed_torque", {"damping": 1.0}, "accepted: gains.<name>"),
        ("none", {"gains.level": 1.0}, "no dynamic gains"),
        ("adaptive", {"gains.lambda.joints": [1.0, 2.0]}, "joints"),
        ("ntsmc", {"gains.boundary_layer": 0.0}, "greater than 0"),
        ("ntsmc", {"gains.k2.joints": {"elbow": 1.0}}, "elbow"),
    ],
)
def test_a_bad_gain_change_is_refused_as_a_whole(name: str, changes: dict[str, Any], why: str) -> None:
    """The error names key and reason; the run goes on as if nothing had been asked."""
    subject, plain = law(name), outputs_of(law(name), {})
    subject.reset()
    for tick, (state, reference) in enumerate(walk(12)):
        if tick == 5:
            with pytest.raises(SpecError, match=why):
                subject.tune(changes)
        output = subject.update(state, reference)
        assert output.command.u.tobytes() == plain[tick].command.u.tobytes()
        assert output.events == ()
