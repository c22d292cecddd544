"""How the plant is integrated: what a file says, turned into what the kernel needs."""

from __future__ import annotations

import numpy as np

from space_robot_description.kernel import jit
from space_robot_description.kernel.arrays import RobotArrays
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_sim.kernel.rhs import COULOMB, LAG, VISCOUS
from space_robot_sim.kernel.steps import DOP853, DOP853_ADAPTIVE, DOP853_CHECKED, RK4, Stepping
from space_robot_sim.spec import IntegratorSpec, fixed_steps, method

_CODES = {"dop853": DOP853, "dop853_adaptive": DOP853_ADAPTIVE, "rk4": RK4}


def compiled(spec: IntegratorSpec) -> bool:
    """True if the compiled kernel is to be used.

    Raises:
        SpecError: it is asked for and numba is not installed.
    """
    if spec.kernel == "numba" and not jit.INSTALLED:
        raise SpecError(
            "numba is not installed", key="plant.integrator.kernel", value="numba", accepted="auto, pinocchio"
        )
    return jit.COMPILED and spec.kernel != "pinocchio"


def stepping(
    spec: IntegratorSpec, robot: RobotArrays, period: int, *, rough: bool = False, fastest: float = 0.0
) -> Stepping:
    """What the kernel is given.

    Args:
        spec: what the file says.
        robot: its motors decide what ``auto`` means.
        period: control period [ns].
        rough: its joints get friction in the course of the run.
        fastest: largest eigenvalue of its modes [1/s], where it is flexible.

    Raises:
        SpecError: the period is not a whole number of nanoseconds per fixed step, or holds too many of them; a step
            does not resolve the fastest mode.
    """
    kind = method(spec, rough=rough or bool(robot.motors[:, [LAG, VISCOUS, COULOMB]].any()))
    step = period / NANOSECONDS
    if kind != "dop853_adaptive":
        step /= fixed_steps(spec, kind, period, fastest)
    # What the file says in so many words is done; `auto` looks at the error.
    code = DOP853_CHECKED if (spec.kind, kind) == ("auto", "dop853") else _CODES[kind]
    return Stepping(code, step, spec.rtol, spec.atol, np.zeros(1))
