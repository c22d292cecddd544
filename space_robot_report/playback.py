"""What is shown of a log in space, by the report's page and by the viewer alike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_description.kernel.joints import joint_axes as moving_axes
from space_robot_description.mimic import has_followers
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.log.arrays import LogArrays

# Why a mesh is not drawn.
WITHOUT = "not on this machine, not readable, or outside of shipped robots, packages and --meshes DIR"


@dataclass(frozen=True, eq=False, slots=True)
class Footage:
    """A log of K ticks.

    Attributes:
        time: (K,) [s].
        q: (K, 7+n) true configuration, or the measured one where the plant does not tell.
        q_d: (K, 7+n) desired configuration.
        torque: (K, 3) on the base in its frame, over the largest of the run [-].
        efforts: (K, n) of the joints, over the largest of the run [-].
    """

    time: Vector
    q: Vector
    q_d: Vector
    torque: Vector
    efforts: Vector

    @classmethod
    def of(cls, arrays: LogArrays) -> Footage:
        """From a log; what acts after a tick is what its plant tells at the next: the mean over the period between."""
        wrench, effort = arrays.wrench, arrays.effort_command
        if "applied_wrench" in arrays.plant:
            wrench, effort = _next(arrays.plant["applied_wrench"]), _next(arrays.plant["applied_effort"])
        q = arrays.plant.get("true_configuration", arrays.q)
        return cls(arrays.time, q, arrays.q_d, _share(wrench[:, 3:]), _share(effort))


def way_of(model: Any, configurations: Vector, frame: str) -> Vector:
    """(K, 3) positions of a link [m], inertial frame."""
    data, number = model.createData(), model.getFrameId(frame, pin.FrameType.BODY)
    positions = []
    for q in configurations:
        pin.forwardKinematics(model, data, q)
        positions.append(np.array(pin.updateFramePlacement(model, data, number).translation))
    return np.array(positions)


def joint_axes(model: Any) -> Vector:
    """(N, 3) axis of every joint in the frame of the body it moves, also of those that follow others."""
    if has_followers(model):
        return moving_axes(model)[0]
    motions = [np.array(joint.createData().S) for joint in model.joints[2:]]
    axes = [motion[3:] if np.any(motion[3:]) else motion[:3] for motion in motions]
    return np.array(axes).reshape(-1, 3)


def efforts_by_joint(model: Any, efforts: Vector) -> Vector:
    """(..., N) of (..., n): nothing acts on joints that follow others."""
    if not has_followers(model):
        return efforts
    out = np.zeros((*efforts.shape[:-1], model.njoints - 2))
    out[..., [index for index, joint in enumerate(model.joints[2:]) if joint.nv]] = efforts
    return out


def _next(rows: Vector) -> Vector:
    return np.vstack([rows[1:], rows[-1:]])


def _share(rows: Vector) -> Vector:
    """The rows over the largest of them; zeros where there is none."""
    largest = float(np.abs(rows).max(initial=0.0))
    return rows / largest if largest > 0.0 else rows
