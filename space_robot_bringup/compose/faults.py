"""From the faults of an experiment to the plan of a run, and to the robots that run in the course of it."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence

import numpy as np

from space_robot_bringup.compose.plants import Changes, capture_tick
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.experiment.plant import PlantSpec
from space_robot_description.payload import Payload, attach_payload
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_sim.capture import RobotChange, TargetSpec, free_body
from space_robot_sim.faults.base import FaultSite
from space_robot_sim.faults.body import BodyFault, PayloadCaptured
from space_robot_sim.faults.plan import FaultPlan, PlannedFault, plan_faults


def fault_plan(experiment: Experiment, truth: Robot, seed: np.random.SeedSequence) -> FaultPlan:
    """The plan of a run.

    Args:
        experiment: with its faults, at least one.
        truth: the true robot, as it starts.
        seed: of everything random in them.

    Raises:
        SpecError: a fault does not fit the robot, the plant or the run.
    """
    spec = experiment.plant
    if not isinstance(spec, PlantSpec):
        accepted = "plant.kind articulated"
        raise SpecError("this plant knows no faults", key="faults", value=spec.kind, accepted=accepted)
    captured = any(isinstance(fault, PayloadCaptured) for fault in experiment.faults)
    laden = captured or spec.payload is not None or spec.capture is not None
    site = FaultSite(truth, spec.sensors, experiment.control_period, laden)
    drawn = int(seed.generate_state(1, np.uint64)[0])
    return plan_faults(experiment.faults, site, period=experiment.period, steps=experiment.steps, seed=drawn)


def robots_with_faults(plan: FaultPlan, bare: Robot, spec: PlantSpec) -> Changes:
    """The true robots of the course of a run with faults of the body, captures included.

    Args:
        plan: of the run.
        bare: the true robot without anything in its hand.
        spec: of the plant.
    """
    happening = [*_caught_by_plan(spec, plan), *plan.of(BodyFault)]
    # In the order of their onsets: what is lost was taken before.
    happening.sort(key=lambda one: (one.first, one.index))
    edges = {one.first for one in happening} | {one.end for one in happening if one.fault.for_ is not None}
    return tuple(change for tick in sorted(edges) for change in _changes_at(tick, happening, bare, spec, plan.period))


def _caught_by_plan(spec: PlantSpec, plan: FaultPlan) -> Iterator[PlannedFault]:
    """What `plant.capture` says, as if it were a fault before all others."""
    if spec.capture is not None:
        target = {name: getattr(spec.capture, name) for name in TargetSpec.model_fields}
        taken = PayloadCaptured(kind="payload_captured", at=spec.capture.time, **target)
        yield PlannedFault(taken, -1, "capture", capture_tick(spec, plan.period / NANOSECONDS), sys.maxsize)


def _changes_at(
    tick: int, happening: Sequence[PlannedFault], bare: Robot, spec: PlantSpec, period: int
) -> Iterator[RobotChange]:
    """One change for all that ends at a tick, then one for each that begins: an impact needs the robot before it."""
    robot = _robot_with([one for one in happening if one.first < tick < one.end], bare, spec)
    if any(one.end == tick for one in happening):
        yield RobotChange(tick * period, robot)
    for index, one in enumerate(happening):
        if one.first == tick:
            acting = [other for other in happening[: index + 1] if other.acts(tick)]
            body = free_body(robot, one.fault) if isinstance(one.fault, PayloadCaptured) else None
            yield RobotChange(tick * period, _robot_with(acting, bare, spec), body)


def _robot_with(acting: Sequence[PlannedFault], bare: Robot, spec: PlantSpec) -> Robot:
    """The robot under these faults, in the order of their onsets."""
    robot = bare
    held: tuple[Payload, ...] = () if spec.payload is None else (spec.payload,)
    for one in acting:
        assert isinstance(one.fault, BodyFault)
        robot, held = one.fault.change(robot), one.fault.hold(held)
    for payload in held:
        robot = attach_payload(robot, payload)
    return robot
