"""Laws that take turns in a run: bumpless, one layout of telemetry, the same bits however a switch is requested."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.judge.metrics import deviations
from space_robot_bringup.modes import headless
from space_robot_control.laws.adaptive.law import Adaptive
from space_robot_control.laws.switching import Switching
from space_robot_msgs_py.errors import ControlError, SpecError
from space_robot_msgs_py.interfaces import Command, ControlOutput, Reference, RobotState, Tick, Vector
from space_robot_msgs_py.log.writer import MemorySink

SWITCHES = {100: ("adaptive", "ntsmc"), 200: ("ntsmc", "mfac"), 300: ("mfac", "adaptive")}
SECOND = 4


class Requesting:
    """A controller that is asked for switches during the run, before the update of some ticks."""

    def __init__(self, law: Switching, requested: dict[int, str]) -> None:
        self._law, self._requested, self._tick = law, requested, 0
        self.reset = law.reset

    def update(self, state: RobotState, reference: Reference) -> ControlOutput:
        """Ask, if it is time, and answer."""
        if self._tick in self._requested:
            self._law.switch_to(self._requested[self._tick])
        self._tick += 1
        return self._law.update(state, reference)


def composed(*overrides: str) -> Composition:
    """The shipped experiment with other values for some keys."""
    return compose(load_experiment("switch/mini", overrides))


def switching(composition: Composition) -> Switching:
    """Its controller."""
    law = composition.controller()
    assert isinstance(law, Switching)
    return law


def run_ticks(composition: Composition, controller: Any = None) -> list[Tick]:
    """All ticks of the run."""
    sink = MemorySink()
    controller = controller or composition.controller()
    steps = composition.experiment.steps
    headless.run(composition.plant(), controller, composition.reference(), steps=steps, sink=sink)
    assert sink.end_reason == "completed"
    return sink.ticks


@cache
def shipped() -> list[Tick]:
    """The shipped experiment as it is."""
    return run_ticks(composed())


@cache
def alone(name: str) -> list[Tick]:
    """The same run under one of its laws."""
    spec = load_experiment("switch/mini").controller.laws[name]
    controller = {"law": spec.law, "gains": spec.gains}
    experiment = load_experiment("switch/mini")
    return run_ticks(compose(type(experiment).model_validate(experiment.model_dump() | {"controller": controller})))


def error(ticks: list[Tick]) -> Vector:
    """(K,) largest angle by which attitude or a joint is off [rad]."""
    q, requested = (
        np.array(values) for values in zip(*((t.sample.state.q, t.reference.q) for t in ticks), strict=True)
    )
    out: Vector = np.abs(deviations(q, requested)[:, 3:]).max(axis=1)
    return out


def torque(ticks: list[Tick]) -> Vector:
    """(K, 3+n) commands in units of their limits."""
    robot = composed().nominal
    limit = np.concatenate([np.full(3, 1.5), robot.effort_limit])
    return np.array([tick.output.command.u[3:] for tick in ticks]) / limit


def bits(ticks: list[Tick]) -> list[Any]:
    """Commands, telemetry and events, as something that is equal only for equal bits."""
    return [(t.output.command.u.tobytes(), t.output.telemetry.data.tobytes(), t.output.events) for t in ticks]


def test_the_robot_goes_on_tracking_through_every_switch() -> None:
    """Until the next switch the error stays within twice that of the worse of the two laws acting alone."""
    error_here, ends = error(shipped()), [*SWITCHES, len(shipped())]
    for (start, names), end in zip(SWITCHES.items(), ends[1:], strict=True):
        worse = max(error(alone(name))[start:end].max() for name in names)
        assert error_here[start:end].max() <= 2.0 * worse, f"after {names}"


def test_no_switch_bumps() -> None:
    """At a switch the command does not step at all, and on the way no more than a law does by itself plus 5 %."""
    steps = np.abs(np.diff(torque(shipped()), axis=0))
    for start, names in SWITCHES.items():
        normal = max(np.abs(np.diff(torque(alone(name)), axis=0)).max() for name in names)
        assert steps[start - 1].max() < 1e-12
        assert steps[start : start + 10 * SECOND].max() <= normal + 0.05


def test_without_a_handover_there_is_a_bump() -> None:
    """The run is one in which a switch matters: with no handover the command steps by 2 % of the limit."""
    steps = np.abs(np.diff(torque(run_ticks(composed("controller.handover=0.0"))), axis=0))
    assert max(steps[start - 1].max() for start in SWITCHES) > 0.02


def test_the_log_has_the_switches() -> None:
    """One event for each, under the stamp of the first command of the new law."""
    reported = {index: event.content for index, tick in enumerate(shipped()) for event in tick.output.events}
    assert reported == {start: {"from": a, "to": b} for start, (a, b) in SWITCHES.items()}


def test_telemetry_has_one_layout_and_nothing_of_idle_laws() -> None:
    """Labels and sizes never change, blocks of inactive laws are 0, active_law says which one is active."""
    names = ["adaptive", "ntsmc", "mfac"]
    assert len({(t.output.telemetry.labels, t.output.telemetry.sizes) for t in shipped()}) == 1
    assert [shipped()[tick].output.telemetry["active_law"].item() for tick in (0, 99, 100, 200, 300)] == [0, 0, 1, 2, 0]
    owners = {label.partition(".")[0] for label in shipped()[0].output.telemetry.labels}
    assert owners > set(names)
    for tick in shipped():
        active = names[int(tick.output.telemetry["active_law"].item())]
        for label, block in tick.output.telemetry.items():
            owner = label.partition(".")[0]
            assert owner not in names or owner == active or not block.any(), label
    ntsmc = shipped()[150].output.telemetry
    assert ntsmc["ntsmc.sliding_variable"].any()
    off = shipped()[150].reference.q[7:] - shipped()[150].sample.state.q[7:]
    np.testing.assert_array_equal(ntsmc["joint_error"], off)


def test_a_requested_switch_equals_a_scheduled_one() -> None:
    """Asked for before the update of a tick, it gives the bits of a run whose file has the switch at that tick."""
    plan = "controller.switches=[{time: 25.0, to: ntsmc}]"
    scheduled = run_ticks(composed("duration=40.0", plan))
    composition = composed("duration=40.0", "controller.switches=[]")
    requested = run_ticks(composition, Requesting(switching(composition), {100: "ntsmc"}))
    assert bits(requested) == bits(scheduled)
    again = composed("duration=40.0", plan)
    both = run_ticks(again, Requesting(switching(again), {100: "ntsmc"}))
    assert bits(both) == bits(scheduled), "a switch that is requested and scheduled happens once"


def test_a_reset_controller_repeats_its_run() -> None:
    """After a run with switches a reset controller repeats it, first law and events included."""
    composition = composed("duration=60.0")
    law = composition.controller()
    assert bits(run_ticks(composition, law)) == bits(run_ticks(composition, law))


class Uninformed(Adaptive):
    """An adaptive law that takes its own command for the applied one."""

    def control(self, state: RobotState, reference: Reference) -> ControlOutput:
        """Keep what it would send."""
        output = super().control(state, reference)
        self._own: Command | None = output.command
        return output

    def on_applied(self, command: Command, *, own: bool) -> None:
        """Pass on the own command, where there is one."""
        super().on_applied(self._own or command, own=True)
        self._own = None


def test_an_estimator_sees_the_applied_command() -> None:
    """During a handover an exact model explains the motion; with its own command it does not."""
    largest = []
    for law in ("adaptive", f"{__name__}:Uninformed"):
        standby = f"{{learning: {{law: '{law}'}}}}, switches: [{{time: 20, to: learning}}], handover: 5.0"
        controller = f"controller={{law: pd, gains: {{bandwidth: 0.4}}, standby: {standby}}}"
        ticks = run_ticks(composed("duration=25.0", controller, "plant.payload=null"))
        largest.append(max(np.abs(tick.output.telemetry["learning.innovation"]).max() for tick in ticks[81:]))
    assert largest[0] < 0.2 * largest[1]


def test_an_idle_law_counts_the_momentum_of_the_wheels() -> None:
    """Having acted a quarter of the time only, it knows what the wheels hold as if it had acted all the time."""
    composition = composed("controller.gains.update=none")
    law = composition.controller()
    last = run_ticks(composition, law)[-1]
    wheels = law._laws["adaptive"].wheels  # type: ignore[attr-defined]
    held = wheels.momentum + 0.25 * last.output.command.wrench[3:]
    np.testing.assert_allclose(held, last.sample.telemetry["wheel_momentum"], atol=1e-12)


def test_a_law_that_gives_up_is_named_once() -> None:
    """The error is that of the active law, as if it acted alone: law, quantity, time."""
    composition = composed("controller={law: none, standby: {fails: {law: 'tests.support.laws:GivesUp'}}, handover: 0}")
    law = switching(composition)
    law.switch_to("fails")
    state = RobotState(0, [0.0] * 6 + [1.0] + [0.0] * 4, np.zeros(10), np.zeros(4), np.zeros(3))
    law.update(state, Reference(0, state.q, state.v, state.v))
    later = RobotState(10**9, state.q, state.v, np.zeros(4), np.zeros(3))
    with pytest.raises(ControlError, match=r"^gives_up: patience: enough at t = 1 s$"):
        law.update(later, Reference(10**9, state.q, state.v, state.v))


def test_gains_of_each_law_can_be_changed() -> None:
    """Names say whose gain it is; a standby law starts with what was set before it took over."""
    law = switching(composed())
    names = {row.name for row in law.parameters() if row.dynamic}
    assert {"active_law", "gains.kappa", "standby.ntsmc.gains.k1", "standby.mfac.gains.kappa"} <= names
    law.tune({"standby.ntsmc.gains.k1": 0.5})
    assert {row.name: row.value for row in law.parameters()}["standby.ntsmc.gains.k1"] == 0.5
    law.tune({"active_law": "ntsmc"})
    state = RobotState(0, [0.0] * 6 + [1.0] + [0.0] * 4, np.zeros(10), np.zeros(4), np.zeros(3))
    output = law.update(state, Reference(0, state.q, state.v, state.v))
    assert [event.kind for event in output.events] == ["parameters", "switch"]
    assert law.active == "ntsmc"


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"active_law": "ntsm"}, "accepted: ntsmc"),
        ({"active_law": ["ntsmc"]}, "not among the laws"),
        ({"standby.pd.gains.bandwidth": 1.0}, "standby.ntsmc.gains"),
        ({"gains.kappa": 1.0, "standby.ntsmc.gains.k1": 0.1}, "one law at a time"),
        ({"standby.ntsmc.gains.k1": -1.0}, "greater than or equal to 0"),
    ],
)
def test_a_gain_that_cannot_change_is_refused_with_those_that_can(changes: dict[str, Any], why: str) -> None:
    """The error says what could be."""
    with pytest.raises(SpecError, match=why):
        switching(composed()).tune(changes)


@pytest.mark.parametrize(
    ("override", "why"),
    [
        ("controller.switches=[{time: 25.1, to: ntsmc}]", r"switches\.0\.time.*multiple of control_period"),
        ("controller.switches=[{time: 25.0, to: ntsm}]", r"switches\.0\.to.*accepted: ntsmc"),
        ("controller.switches=[{time: 25.0, to: ntsmc}, {time: 25.0, to: mfac}]", r"switches\.1\.time"),
        ("controller.standby={adaptive: {}}", r"standby\.adaptive.*another name"),
        ("controller.standby.ntsmc.gains={gama: 1}", r"standby\.ntsmc\.gains\.gama.*gamma"),
        ("controller.standby.own={law: nothing}", r"standby\.own\.law"),
        ("controller.handover=-1.0", "controller.handover"),
    ],
)
def test_a_bad_file_is_refused(override: str, why: str) -> None:
    """Before any run, with key and reason."""
    with pytest.raises(SpecError, match=why):
        composed(override)
