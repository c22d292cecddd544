"""Experiment in, ready-made objects out: the one place that knows how a run is put together."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from space_robot_bringup.compose.flexibility import check_flexibility
from space_robot_bringup.compose.knowledge import nominal_spec, with_knowledge
from space_robot_bringup.compose.plants import PLANTS, Changes, PlantParts, check_brakes, check_unloading
from space_robot_bringup.compose.robots import initial_state, unladen, variant_of
from space_robot_bringup.compose.versions import versions
from space_robot_bringup.experiment.expectations import AnyExpectation
from space_robot_bringup.experiment.experiment import Experiment, to_yaml
from space_robot_bringup.experiment.plant import PlantSpec
from space_robot_bringup.judge.assertions import check_assertions
from space_robot_bringup.judge.metrics import axis_names, metric_names
from space_robot_bringup.judge.verdict import check_bands
from space_robot_control.laws.policy import TYPED, LawPolicy
from space_robot_control.references.make import make_reference
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.bounded_yaml import values_in
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Plant, Reference, ReferenceSource, Vector
from space_robot_msgs_py.limits import YAML_BYTES, YAML_NODES
from space_robot_msgs_py.log.header import LogHeader
from space_robot_msgs_py.topics import (
    EVENTS,
    FAULTS,
    HOUSEKEEPING,
    PLANT_EVENTS,
    SUPERVISOR_MODE,
    WHEEL_MOMENTUM,
    Topic,
)
from space_robot_sim.faults.plan import FaultPlan
from space_robot_sim.initial import InitialState

if TYPE_CHECKING:
    from space_robot_bringup.compose.run_supervisor import RunSupervisor
    from space_robot_control.laws.base import Law, Review
    from space_robot_sim.faults.wires import ControllerInbox

# References that a law reviews before a run.
PATH_POINTS = 200


@dataclass(frozen=True, eq=False, slots=True)
class Composition:
    """The parts of one run.

    Attributes:
        experiment: what it was made from.
        nominal: the robot the flight software believes in.
        truth: the true robot, as it starts.
        changes: the true robots of the course of the run, in order.
        faults: what goes wrong; None: nothing.
        policy: whose code may be its laws.
    """

    experiment: Experiment
    nominal: Robot
    truth: Robot
    changes: Changes
    faults: FaultPlan | None
    policy: LawPolicy
    _reference: ReferenceSource
    _seeds: tuple[np.random.SeedSequence, ...]
    _q0: Vector
    _v0: Vector

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Joint names in model order."""
        return self.nominal.joint_names

    @property
    def initial(self) -> tuple[Vector, Vector]:
        """Where the run starts: (7+n,) configuration and (6+n,) velocity, as in RobotState."""
        return self._q0, self._v0

    @property
    def optional_topics(self) -> tuple[Topic, ...]:
        """The topics that only some runs have and this one does."""
        table, sensors = self.experiment.supervision, getattr(self.experiment.plant, "sensors", None)
        wanted = {
            EVENTS: table,
            FAULTS: self.faults,
            PLANT_EVENTS: self.experiment.plant.monitor,
            SUPERVISOR_MODE: table,
            HOUSEKEEPING: None if table is None else table.housekeeping,
            WHEEL_MOMENTUM: None if sensors is None else sensors.wheel_momentum,
        }
        return tuple(topic for topic, section in wanted.items() if section is not None)

    @property
    def braked(self) -> bool:
        """The supervisor may close the brakes of the joints."""
        return self.experiment.supervision is not None and self.experiment.supervision.brakes

    @property
    def unloads(self) -> bool:
        """The supervisor may have thrusters unload the wheels."""
        return self.experiment.supervision is not None and self.experiment.supervision.unloads

    @property
    def loses_commands(self) -> bool:
        """Faults keep commands from the plant: what acted does not tell what was sent."""
        if self.faults is None:
            return False
        from space_robot_sim.faults.wires import CommandWire

        return CommandWire(self.faults).faulty

    @property
    def header(self) -> LogHeader:
        """Provenance for a log; made when asked for, which a run that is not logged never does.

        Raises:
            SpecError: the resolved experiment is larger than what a log is read with.
        """
        robot = self.nominal
        resolved = self.experiment.model_copy(update={"robot": dict(robot.resolved)})
        text = to_yaml(resolved)
        # What is written has to be readable: a recorded reference may be of any length until here.
        YAML_BYTES.check(len(text.encode()), "experiment, resolved")
        YAML_NODES.check(values_in(resolved.model_dump(mode="json")), "experiment, resolved")
        # Only here and below: a log is judged without a law and its compiler, which take 90 MB.
        from space_robot_bringup.compose.controllers import law_sources

        laws = law_sources(self.experiment.controller, self.policy)
        topics = tuple(topic.name for topic in self.optional_topics)
        return LogHeader(text, robot.urdf, self.experiment.seed, robot.joint_names, versions(), laws, topics)

    def plant(self) -> Plant:
        """A new plant in its initial state."""
        seed = int(self._seeds[2].generate_state(1, np.uint64)[0])
        initial, spec = InitialState(self._q0, self._v0), self.experiment.plant
        modes = self.braked, self.unloads
        parts = PlantParts(self.truth, self.experiment.period, initial, seed, self.changes, self.faults, *modes)
        return PLANTS[spec.kind].make(spec, parts)

    def controller(self) -> Law:
        """A new controller; it gets the nominal robot and nothing else.

        Raises:
            SpecError: a law or a gain cannot be used.
            CodeError: the policy does not let a law be imported.
        """
        from space_robot_bringup.compose.controllers import make_controller

        experiment = self.experiment
        law: Law
        if experiment.supervision is not None:
            from space_robot_bringup.compose.supervision import supervised

            law = supervised(experiment, self.nominal, self.policy)
        else:
            law = make_controller(experiment.controller, self.nominal, experiment.control_period, self.policy)
        if (inbox := self._inbox()) is not None:
            law.inbox = inbox
        return law

    def supervisor(self, controller: Law | None = None) -> RunSupervisor | None:
        """A new supervisor; None: the run has none.

        Args:
            controller: of this composition, which is asked for the labels of its telemetry; None: one is made for it.

        Raises:
            SpecError: it reads what there is not.
        """
        if self.experiment.supervision is None:
            return None
        from space_robot_bringup.compose.run_supervisor import run_supervisor

        return run_supervisor(self.experiment, self.nominal, controller or self.controller(), self._inbox())

    def _inbox(self) -> ControllerInbox | None:
        if self.faults is None:
            return None
        from space_robot_sim.faults.wires import ControllerInbox

        return ControllerInbox(self.faults)

    def reference(self) -> ReferenceSource:
        """The reference source: a function of time, which all who ask share."""
        return self._reference

    def review(self) -> Review:
        """What the law says about this run before it, see ``Law.review``, and whether it knows when commands act."""
        from space_robot_control.laws.base import Review

        source, experiment = self.reference(), self.experiment
        if experiment.controller.external:
            return Review()
        still = np.zeros(self._v0.size)
        stride = max(1, experiment.steps // PATH_POINTS)
        stamps = [tick * experiment.period for tick in range(0, experiment.steps + 1, stride)]
        law = self.controller()
        found = law.review([Reference(0, self._q0, self._v0, still), *map(source.at, stamps)])
        return replace(found, warnings=(*found.warnings, *_delay_warnings(experiment, law)))


def compose(experiment: Experiment, policy: LawPolicy = TYPED, load: Callable[..., Robot] = load_robot) -> Composition:
    """Build robots and provenance and check that every part can be made.

    Args:
        experiment: what the user wants to run.
        policy: whose code may be its laws; the default lets the experiment name any. What comes out of a log is
            composed by ``logged.compose_logged``, which makes no law.
        load: see ``compose_world``.

    Raises:
        SpaceRobotError: a part refuses its input; the message names the key.
    """
    composition = compose_world(experiment, policy, load)
    if experiment.controller.external and experiment.supervision is not None:
        raise SpecError("needs a law of this project", key="supervision", accepted="a run without it")
    if not experiment.controller.external:
        composition.supervisor(composition.controller())
    return composition


def compose_world(experiment: Experiment, policy: LawPolicy, load: Callable[..., Robot] = load_robot) -> Composition:
    """``compose`` without making a law: no code of one is imported.

    Args:
        experiment: what the user wants to run.
        policy: see ``compose``.
        load: gives the robot, as ``load_robot`` does; a study of many runs reads its file once.

    Raises:
        SpaceRobotError: a part refuses its input; the message names the key.
    """
    # Fixed positions: adding randomness to one part never changes another's draws.
    seeds = tuple(np.random.SeedSequence(experiment.seed).spawn(5))
    disorder = experiment.plant.dispersion
    if disorder is not None and disorder.inconsistent == "keep":
        raise SpecError(
            "the real robot is physically possible",
            key="plant.dispersion.inconsistent",
            value="keep",
            accepted="reject",
        )
    if experiment.supervision is not None:
        # It knows the laws, which load a compiler.
        from space_robot_bringup.compose.supervision import check_supervision

        check_supervision(experiment)
    robot = load(experiment.robot)
    nominal = with_knowledge(variant_of(robot, nominal_spec(experiment), seeds[0]), experiment.nominal)
    truth = variant_of(robot, experiment.plant, seeds[1])
    q0, v0 = initial_state(experiment.initial, robot)
    check_brakes(experiment, truth)
    check_unloading(experiment, truth)
    kind, spec = PLANTS[experiment.plant.kind], experiment.plant
    kind.check(spec, truth, experiment.period)
    changes = kind.changes(spec, truth, experiment.control_period)
    plan = None
    if experiment.faults:
        # Models of faults take their time to be made, and few runs have any.
        from space_robot_bringup.compose.faults import fault_plan, robots_with_faults

        plan = fault_plan(experiment, truth, seeds[4])
        if isinstance(spec, PlantSpec):
            changes = robots_with_faults(plan, variant_of(robot, unladen(spec), seeds[1]), spec)
    check_flexibility(experiment, truth, changes, plan)
    reference = make_reference(experiment.reference, nominal, q0)
    composition = Composition(experiment, nominal, truth, changes, plan, policy, reference, seeds, q0, v0)
    free_flying = nominal.base_mode == "free_flying"
    check_expect(experiment.expect, composition)
    check_bands(experiment.settling_bands, axis_names(robot.joint_names, base_translation=free_flying))
    _check_recorded(experiment)
    return composition


def check_expect(expect: Mapping[str, AnyExpectation], composition: Composition) -> None:
    """Refuse what is expected of a run and cannot be judged: metrics, signals, modes and events there will not be.

    Raises:
        SpecError: with the nearest names.
    """
    nominal = composition.nominal
    metrics = metric_names(nominal.joint_names, base_translation=nominal.base_mode == "free_flying")
    check_assertions(expect, nominal, composition.experiment, composition.faults, metrics)


def _check_recorded(experiment: Experiment) -> None:
    """A recorded reference has a row for every tick up to its last; a gap would end the run."""
    spec = experiment.reference
    if spec.kind != "recorded":
        return
    known, end = set(spec.stamps), min(spec.stamps[-1], experiment.steps * experiment.period)
    missing = next((stamp for stamp in range(0, end + 1, experiment.period) if stamp not in known), None)
    if missing is not None:
        accepted = "one at every multiple of control_period up to the last"
        raise SpecError(f"none at {missing} ns", key="reference.stamps", value=list(spec.stamps[:3]), accepted=accepted)


def _delay_warnings(experiment: Experiment, law: Law) -> Iterator[str]:
    real, known = experiment.plant.delay_periods, experiment.nominal.delay_periods
    if real > known:
        yield f"plant.delay_periods={real}, but the law knows of {known}: see nominal.delay_periods"
    if real and known and not law.uses_command_delay:
        yield f"{law.name or type(law).__qualname__} takes no account of nominal.delay_periods={known}"
