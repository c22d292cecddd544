"""How the plant is integrated: what a file says, turned into what the kernel needs."""

from __future__ import annotations

import math

import numpy as np

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_sim.kernel import jit
from space_robot_sim.kernel.arrays import RobotArrays
from space_robot_sim.kernel.rhs import COULOMB, LAG, VISCOUS
from space_robot_sim.kernel.steps import DOP853, DOP853_ADAPTIVE, RK4, Stepping
from space_robot_sim.spec import IntegratorSpec

_STEP = {DOP853: 0.05, RK4: 0.005}


def compiled(spec: IntegratorSpec) -> bool:
    """True if the compiled kernel is to be used.

    Raises:
        SpecError: it is asked for and numba is not installed.
    """
    if spec.kernel == "numba" and not jit.COMPILED:
        raise SpecError("numba is not installed", key="integrator.kernel", value="numba", accepted="auto, pinocchio")
    return jit.COMPILED and spec.kernel != "pinocchio"


def stepping(spec: IntegratorSpec, robot: RobotArrays, period: int) -> Stepping:
    """What the kernel is told.

    Args:
        spec: what the file says.
        robot: its motors decide what ``auto`` means.
        period: control period [ns].

    Raises:
        SpecError: the period is not a whole number of nanoseconds per fixed step.
    """
    method = _method(spec, robot)
    step = period / NANOSECONDS
    if method != DOP853_ADAPTIVE:
        longest = spec.step or _STEP[method]
        # The margin lets 0.1 s be two steps of 0.05 s whatever the rounding of the quotient.
        substeps = max(1, math.ceil(step / longest - 1e-9))
        if period % substeps:
            raise SpecError(
                f"a control period of {period} ns does not divide into {substeps} equal steps",
                key="integrator.step",
                value=longest,
                accepted="a step that divides the control period into whole nanoseconds",
            )
        step /= substeps
    return Stepping(method, step, spec.rtol, spec.atol, np.zeros(1))


def _method(spec: IntegratorSpec, robot: RobotArrays) -> int:
    kind = spec.kind
    if kind == "auto":
        kind = "dop853_adaptive" if robot.motors[:, [LAG, VISCOUS, COULOMB]].any() else "dop853"
    return {"dop853": DOP853, "dop853_adaptive": DOP853_ADAPTIVE, "rk4": RK4}[kind]
