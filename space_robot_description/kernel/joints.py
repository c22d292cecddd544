"""The joints of a free-flying tree as a kernel wants them: one degree of freedom each, along or about an axis."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector

# As Pinocchio calls it. Here, where no compiler is loaded: `robot` and `info` look at axes and run nothing.
MIMIC = "JointModelMimic"


def joint_axes(model: Any) -> tuple[Vector, npt.NDArray[np.bool_]]:
    """Return the unit axes (N, 3) of the joints in their own frames, and which of them (N,) slide.

    Args:
        model: free-flyer root, then joints with one degree of freedom each or JointModelMimic, no gravity, no armature.

    Raises:
        SpecError: the model is not such a robot.
    """
    _check(model)
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    axes, slides = np.zeros((model.njoints - 2, 3)), np.zeros(model.njoints - 2, dtype=bool)
    for index in range(2, model.njoints):
        column = _column(model, data, index)
        slides[index - 2] = _slides(column, model.names[index])
        axes[index - 2] = column[:3] if slides[index - 2] else column[3:]
    return axes, slides


def _column(model: Any, data: Any, index: int) -> Vector:
    """(6,) how the body moves with its joint."""
    joint = model.joints[index]
    if joint.shortname() == MIMIC:
        # The Jacobian has what the master moves in the same column.
        column: Vector = np.array(data.joints[index].S).ravel() / joint.extract().scaling
        return column
    column = pin.getJointJacobian(model, data, index, pin.LOCAL)[:, joint.idx_v]
    return column


def _check(model: Any) -> None:
    if model.njoints < 2 or model.joints[1].shortname() != "JointModelFreeFlyer":
        raise SpecError("the first joint is not a free-flyer", key="robot.model", accepted="JointModelFreeFlyer")
    for index in range(2, model.njoints):
        joint = model.joints[index]
        if (joint.nq, joint.nv) != (1, 1) and joint.shortname() != MIMIC:
            raise SpecError(
                f"joint {model.names[index]} does not have one degree of freedom",
                key="robot.model",
                value=joint.shortname(),
                accepted="revolute (with limits, or continuous as one angle) and prismatic joints",
            )
    if np.any(model.gravity.vector):
        raise SpecError("gravity is not zero", key="robot.model.gravity", value=model.gravity.vector.tolist())
    if np.any(model.armature):
        raise SpecError(
            "rotor armature has no place in the momentum balance",
            key="robot.model.armature",
            value=model.armature.tolist(),
            accepted="zeros, with the rotors' inertia in the links",
        )


def _slides(column: Vector, name: str) -> bool:
    linear, angular = np.linalg.norm(column[:3]), np.linalg.norm(column[3:])
    if min(linear, angular) > 1e-12 or abs(max(linear, angular) - 1.0) > 1e-9:
        raise SpecError(f"joint {name} is neither revolute nor prismatic", key="robot.model", value=column.tolist())
    return bool(linear > angular)
