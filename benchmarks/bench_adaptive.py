"""One control cycle of the adaptive law on `mini`, and how it grows with the number of joints.

The contenders take turns, run by run, so that a neighbour's load hits all of them; of every row the tenth
percentile is given, which is what a cycle takes when nothing interrupts it. Liu, Teng and Jin (2023) give 1e-4 s for
theirs, on a machine they do not name: so one ABA of Pinocchio and one computed-torque update of the same robot stand
beside it.
"""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

import numpy as np
import pinocchio as pin

from space_robot_control.laws.adaptive.kernel.regressor import slotine_li
from space_robot_control.laws.adaptive.kernel.tree import places, tree_of
from space_robot_control.laws.adaptive.law import Adaptive
from space_robot_control.laws.adaptive.regressor import Regressor
from space_robot_control.laws.computed_torque.law import ComputedTorque
from space_robot_description.kernel.jit import bound
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_description.rotations import from_rpy
from space_robot_msgs_py.interfaces import NANOSECONDS, Reference, RobotState, Vector
from tests.support.robots import arm_model, robot_of

PERIOD, CYCLES, ROUNDS = 0.25, 200, 21
UPDATES = ("none", "rls", "lyapunov", "composite")
JOINTS = (4, 7, 14)
PAPER = 1e-4  # [s] per cycle, Liu, Teng, Jin (2023), sec. 4

Cycle = Callable[[int], object]


def run() -> dict[str, float]:
    """Microseconds per cycle, the ratio to the paper's, and the growth with the number of joints."""
    robot = load_robot("mini")
    seconds = _measure(_on_mini(robot) | {f"{n} joints": _rls_of(robot_of(_arm(n), floating=True)) for n in JOINTS})
    table = {f"{name}: us": 1e6 * seconds[name] for name in seconds if not name.endswith("joints")}
    for update in UPDATES:
        table[f"{update}, law + update + regressor: times as fast as 1e-4 s"] = PAPER / seconds[f"{update}, compute"]
    for n in JOINTS:
        row = f"rls, compute, arm of {n} joints"
        table[f"{row}: us"] = 1e6 * seconds[f"{n} joints"]
        table[f"{row}: times that of {JOINTS[0]}"] = seconds[f"{n} joints"] / seconds[f"{JOINTS[0]} joints"]
    return table


def _arm(joints: int) -> pin.Model:
    """The arm of the other benchmarks; beyond seven joints its bodies stay as light as the last."""
    model = arm_model(min(joints, 7))
    for index in range(7, joints):
        joint = getattr(pin, "JointModelR" + "ZYYXYXZ"[index % 7])()
        last = model.addJoint(model.njoints - 1, joint, model.jointPlacements[3], f"joint_{index}")
        model.appendBodyToJoint(last, model.inertias[8], pin.SE3.Identity())
    return model


def _on_mini(robot: Robot) -> dict[str, Cycle]:
    """What is compared, each taking the number of a cycle."""
    states = _states(robot)
    cycles: dict[str, Cycle] = {}
    for update in UPDATES:
        for whole in (False, True):
            law = Adaptive(robot, PERIOD, Adaptive.Gains.model_validate({"update": update}))
            name = f"{update}, {'Law.update' if whole else 'compute'}"
            cycles[name] = _law_cycle(law, states, whole=whole)
    cycles["regressor alone"] = _regressor(robot)
    cycles["regressor alone, Pinocchio and polarisation"] = _pinocchio_regressor(robot)
    cycles["pin.aba"] = _aba(robot)
    cycles["computed_torque, Law.update"] = _law_cycle(ComputedTorque(robot, PERIOD), states, whole=True)
    return cycles


def _rls_of(robot: Robot) -> Cycle:
    return _law_cycle(Adaptive(robot, PERIOD, Adaptive.Gains(update="rls")), _states(robot), whole=False)


def _states(robot: Robot) -> list[tuple[RobotState, Reference]]:
    """Smooth small motions about home, and references just off them."""
    rng = np.random.default_rng(12)
    amplitude, phase = 0.02 * rng.uniform(0.5, 1.0, 3 + robot.n), rng.uniform(0.0, 6.0, 3 + robot.n)
    angular = rng.uniform(0.1, 0.3, 3 + robot.n)
    states = []
    for k in range(CYCLES):
        angle = angular * PERIOD * k + phase
        turned, rates = amplitude * np.sin(angle), amplitude * angular * np.cos(angle)
        q = np.array([0.0, 0.0, 0.0, *from_rpy(turned[:3]), *(robot.home + turned[3:])])
        v = np.array([0.0, 0.0, 0.0, *rates])
        stamp = round(NANOSECONDS * PERIOD * k)
        state = RobotState(stamp, q, v, np.zeros(robot.n), np.zeros(3))
        states.append((state, Reference(stamp, q, 1.01 * v, np.zeros(6 + robot.n))))
    return states


def _law_cycle(law: Adaptive | ComputedTorque, states: list[tuple[RobotState, Reference]], *, whole: bool) -> Cycle:
    call = law.update if whole else law.compute

    def cycle(k: int) -> object:
        if k == 0:
            law.reset()
        return call(*states[k])

    return cycle


def _regressor(robot: Robot) -> Cycle:
    size = 6 + robot.n
    pi, rows, vectors = np.array(Regressor(robot).parameters), np.zeros((size, 10 * (1 + robot.n))), _vectors(size)
    arguments = (tree_of(robot.model), places(robot.n), *vectors, pi, True, rows)
    compiled = bound(slotine_li, *arguments)
    return lambda k: compiled(*arguments)


def _pinocchio_regressor(robot: Robot) -> Cycle:
    regressor, vectors = Regressor(robot), _vectors(6 + robot.n)
    return lambda k: regressor.slotine_li(*vectors)


def _aba(robot: Robot) -> Cycle:
    model, data = robot.model, robot.model.createData()
    q, v, u = pin.neutral(model), np.full(model.nv, 0.1), np.full(model.nv, 0.2)
    return lambda k: pin.aba(model, data, q, v, u)


def _vectors(size: int) -> tuple[Vector, ...]:
    return tuple(np.random.default_rng(13).uniform(-1.0, 1.0, (4, size)))


def _measure(cycles: dict[str, Cycle]) -> dict[str, float]:
    """Tenth percentile of the time of single calls [s]."""
    times: dict[str, list[float]] = {name: [] for name in cycles}
    for _ in range(ROUNDS):
        for name, cycle in cycles.items():
            for k in range(CYCLES):
                began = perf_counter()
                cycle(k)
                times[name].append(perf_counter() - began)
    return {name: float(np.percentile(values, 10)) for name, values in times.items()}
