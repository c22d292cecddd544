"""How the plant is integrated: what a file may say, and what that means for a robot and a control period."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field, PositiveFloat

from space_robot_description.spec import Strict
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_sim.kernel import jit
from space_robot_sim.kernel.arrays import RobotArrays
from space_robot_sim.kernel.rhs import COULOMB, LAG, VISCOUS
from space_robot_sim.kernel.steps import DOP853, DOP853_ADAPTIVE, RK4, Stepping

_STEP = {DOP853: 0.05, RK4: 0.005}


class IntegratorSpec(Strict):
    """Integration of the true robot."""

    kind: Literal["auto", "dop853", "dop853_adaptive", "rk4"] = Field(
        default="auto", description="auto: dop853 in fixed steps, dop853_adaptive where a motor has lag or friction"
    )
    step: PositiveFloat | None = Field(
        default=None, description="longest fixed step [s]; default 0.05 (dop853), 0.005 (rk4)"
    )
    rtol: PositiveFloat = Field(default=1e-9, description="relative tolerance of an adaptive step")
    atol: PositiveFloat = Field(default=1e-12, description="absolute tolerance of an adaptive step [SI units]")
    kernel: Literal["auto", "numba", "pinocchio"] = Field(
        default="auto", description="auto: compiled where numba is installed, over pinocchio where not"
    )


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
