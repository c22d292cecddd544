"""From the faults of an experiment to the plan of a run, and to the robots that run in the course of it."""

from __future__ import annotations

import numpy as np

from space_robot_bringup.compose.plants import Changes, capture_tick
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.experiment.plant import PlantSpec
from space_robot_description.payload import Payload, attach_payload
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_sim.faults.base import FaultSite
from space_robot_sim.faults.body import BodyFault, PayloadCaptured
from space_robot_sim.faults.plan import FaultPlan, plan_faults


def fault_plan(experiment: Experiment, truth: Robot, seed: np.random.SeedSequence) -> FaultPlan | None:
    """The plan of a run; None where nothing goes wrong.

    Args:
        experiment: with its faults.
        truth: the true robot, as it starts.
        seed: of everything random in them.

    Raises:
        SpecError: a fault does not fit the robot, the plant or the run.
    """
    if not experiment.faults:
        return None
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
    """(stamp [ns], robot from then on) of a run with faults of the body, captures included.

    Args:
        plan: of the run.
        bare: the true robot without anything in its hand.
        spec: of the plant.
    """
    faults = plan.of(BodyFault)
    capture = capture_tick(spec, plan.period / NANOSECONDS)
    edges = {one.first for one in faults} | {one.end for one in faults if one.fault.for_ is not None}
    edges |= {capture} if capture >= 0 else set()
    return tuple((tick * plan.period, _robot_at(tick, plan, bare, spec, capture)) for tick in sorted(edges))


def _robot_at(tick: int, plan: FaultPlan, bare: Robot, spec: PlantSpec, capture: int) -> Robot:
    held: tuple[Payload, ...] = () if spec.payload is None else (spec.payload,)
    acting = [(one.first, one.index, one.fault) for one in plan.of(BodyFault) if one.acts(tick)]
    if spec.capture is not None and capture <= tick:
        taken = PayloadCaptured(kind="payload_captured", at=spec.capture.time, payload=spec.capture.payload)
        acting.append((capture, -1, taken))
    robot = bare
    # In the order of their onsets: what is lost was taken before.
    for _, _, fault in sorted(acting, key=lambda one: one[:2]):
        assert isinstance(fault, BodyFault)
        robot, held = fault.change(robot), fault.hold(held)
    for payload in held:
        robot = attach_payload(robot, payload)
    return robot
