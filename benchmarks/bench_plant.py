"""One 0.1 s control period of a 500 kg satellite with a seven-joint arm: this simulator and MuJoCo, same held torques.

Contenders take turns, so that a neighbour's load hits all of them; the error is the largest difference in the
configuration after 2 s from our RK4 at 0.5 ms.
"""

from __future__ import annotations

from collections.abc import Callable
from statistics import median
from time import perf_counter

import numpy as np

from space_robot_description.kernel.arrays import robot_arrays
from space_robot_description.kernel.context import context_of
from space_robot_description.kernel.jit import bound
from space_robot_msgs_py.interfaces import Command, Vector
from space_robot_sim.actuators import capability, motor_numbers
from space_robot_sim.integrators import stepping
from space_robot_sim.kernel.period import PlantContext, advance, keep, plant_memory
from space_robot_sim.plant import InitialState, SimulatedRobot
from space_robot_sim.spec import IntegratorSpec
from tests.support.robots import LivelyMotion, MujocoTwin, arm_model, robot_of

PERIOD, PERIODS, REPEATS, JOINTS = 100_000_000, 20, 41, 7

# A contender starts at q, v and takes one effort per period; it returns the configuration at the end.
Contender = Callable[[], tuple[Callable[[int], object], Callable[[], Vector]]]


def run() -> dict[str, float]:
    """Microseconds per control period (median of runs), error, and speed relative to MuJoCo."""
    efforts = _efforts()
    reference = _final(_plant(IntegratorSpec(kind="rk4", step=0.0005), efforts))
    contenders: dict[str, Contender] = {
        "kernel, DOP853 2 x 50 ms": _kernel(IntegratorSpec(), efforts),
        "kernel, DOP853 1 x 100 ms": _kernel(IntegratorSpec(step=0.1), efforts),
        "kernel, DOP853 adaptive 1e-9": _kernel(IntegratorSpec(kind="dop853_adaptive"), efforts),
        "kernel, RK4 5 ms": _kernel(IntegratorSpec(kind="rk4"), efforts),
        "SimulatedRobot.step, DOP853 2 x 50 ms": _plant(IntegratorSpec(), efforts),
        "SimulatedRobot.step over pinocchio": _plant(IntegratorSpec(kernel="pinocchio"), efforts),
        "MuJoCo, RK4 5 ms": _mujoco(0.005, efforts),
    }
    times: dict[str, list[float]] = {name: [] for name in contenders}
    errors = {name: float(np.abs(_final(contender) - reference).max()) for name, contender in contenders.items()}
    for _ in range(REPEATS):
        for name, contender in contenders.items():
            times[name].append(_seconds(contender) / PERIODS)
    table: dict[str, float] = {}
    for name in contenders:
        table[f"{name}: us per period"] = 1e6 * median(times[name])
        table[f"{name}: error"] = errors[name]
    default = times["kernel, DOP853 2 x 50 ms"]
    ratios = [theirs / own for theirs, own in zip(times["MuJoCo, RK4 5 ms"], default, strict=True)]
    table["kernel, DOP853 2 x 50 ms: times as fast as MuJoCo RK4 5 ms"] = median(ratios)
    table["kernel, DOP853 2 x 50 ms: simulated s per s"] = 0.1 / median(default)
    return table


def _start() -> tuple[Vector, Vector]:
    return LivelyMotion(arm_model(), np.random.default_rng(6)).start()


def _efforts() -> list[Vector]:
    """Recorded joint efforts of a lively motion."""
    motion = LivelyMotion(arm_model(), np.random.default_rng(6))
    plant = SimulatedRobot(robot_of(arm_model()), control_period=PERIOD, initial=InitialState(*motion.start()))
    sample, efforts = plant.reset(), []
    for k in range(PERIODS):
        efforts.append(motion.effort(0.1 * k, sample.state.q, sample.state.v))
        sample = plant.step(Command(k * PERIOD, np.zeros(6), efforts[-1]))
    return efforts


def _kernel(spec: IntegratorSpec, efforts: list[Vector]) -> Contender:
    robot = robot_of(arm_model())
    arrays, able = robot_arrays(robot.model, motor_numbers(robot)), capability(robot, PERIOD)
    how, plant, (q, v) = stepping(spec, arrays, PERIOD), plant_memory(JOINTS, 0), _start()
    commands = [np.concatenate([np.zeros(6), effort]) for effort in efforts]
    context = context_of(PlantContext(arrays, able, how, plant), keep)
    compiled = bound(advance, context.address, commands[0], 0.1, False)

    def start() -> tuple[Callable[[int], object], Callable[[], Vector]]:
        plant.y[:], how.next_step[:] = 0.0, 0.0
        plant.y[: 13 + 2 * JOINTS] = np.concatenate([q, v])
        return lambda k: compiled(context.address, commands[k], 0.1, False), lambda: plant.y[: 7 + JOINTS].copy()

    return start


def _plant(spec: IntegratorSpec, efforts: list[Vector]) -> Contender:
    initial = InitialState(*_start())
    plant = SimulatedRobot(robot_of(arm_model()), control_period=PERIOD, initial=initial, integrator=spec)
    commands = [Command(k * PERIOD, np.zeros(6), effort) for k, effort in enumerate(efforts)]

    def start() -> tuple[Callable[[int], object], Callable[[], Vector]]:
        last = plant.reset()

        def step(k: int) -> None:
            nonlocal last
            last = plant.step(commands[k])

        return step, lambda: last.state.q

    return start


def _mujoco(timestep: float, efforts: list[Vector]) -> Contender:
    twin, (q, v), steps, torque = MujocoTwin(arm_model(), timestep), _start(), round(0.1 / timestep), np.zeros(3)

    def start() -> tuple[Callable[[int], object], Callable[[], Vector]]:
        twin.set(q, v)
        return lambda k: twin.step(torque, efforts[k], steps), lambda: twin.q

    return start


def _final(contender: Contender) -> Vector:
    step, end = contender()
    for k in range(PERIODS):
        step(k)
    return end()


def _seconds(contender: Contender) -> float:
    step, _ = contender()
    began = perf_counter()
    for k in range(PERIODS):
        step(k)
    return perf_counter() - began
