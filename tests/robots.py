"""Robots made of numbers, for tests and benchmarks: random trees, a fixed seven-joint arm, and their MuJoCo twins."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from space_robot_description.robot import Robot
from space_robot_description.spec import Actuators

Vector = npt.NDArray[np.float64]
JOINTS = ("RX", "RY", "RZ", "PX", "PY", "PZ", "RevoluteUnaligned", "PrismaticUnaligned")


def random_inertia(rng: np.random.Generator, mass: float, size: float) -> Any:
    """A physically possible inertia: that of a cloud of point masses."""
    points = rng.normal(size=(8, 3)) * size
    com = points.mean(axis=0)
    spread = (points - com).T @ (points - com) / 8
    return pin.Inertia(mass, com, mass * (np.trace(spread) * np.eye(3) - spread))


def random_model(
    rng: np.random.Generator,
    joints: int,
    *,
    serial: bool = False,
    kinds: tuple[str, ...] = JOINTS,
    base_mass: float = 60.0,
) -> Any:
    """A free-flying tree with random shape, joint types, axes and inertias."""
    model = pin.Model()
    model.gravity.setZero()
    last = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    model.appendBodyToJoint(last, random_inertia(rng, base_mass, 0.5), pin.SE3.Identity())
    for index in range(joints):
        kind = kinds[rng.integers(len(kinds))]
        axis = rng.normal(size=3)
        joint = getattr(pin, f"JointModel{kind}")(
            *([axis / np.linalg.norm(axis)] if kind.endswith("Unaligned") else [])
        )
        parent = last if serial else int(rng.integers(1, model.njoints))
        placement = pin.SE3(pin.Quaternion(_unit(rng.normal(size=4))).matrix(), rng.normal(size=3) * 0.3)
        last = model.addJoint(parent, joint, placement, f"joint_{index}")
        model.appendBodyToJoint(last, random_inertia(rng, rng.uniform(1.0, 8.0), 0.15), pin.SE3.Identity())
    return model


def arm_model(joints: int = 7) -> Any:
    """A 500 kg satellite with a 32 kg arm, its axes in turn about z, y, y, x, ..."""
    model = pin.Model()
    model.gravity.setZero()
    last = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    model.appendBodyToJoint(last, pin.Inertia(500.0, np.zeros(3), np.diag([90.0, 110.0, 120.0])), pin.SE3.Identity())
    for index in range(joints):
        joint = getattr(pin, "JointModelR" + "zyyxyxz"[index % 7].upper())()
        placement = pin.SE3(np.eye(3), np.array([0.1, 0.0, 0.5] if index == 0 else [0.05, 0.02, 0.4]))
        last = model.addJoint(last, joint, placement, f"joint_{index}")
        mass = 7.0 - 0.8 * index
        inertia = pin.Inertia(mass, np.array([0.02, 0.01, 0.2]), mass * np.diag([0.02, 0.018, 0.004]))
        model.appendBodyToJoint(last, inertia, pin.SE3.Identity())
    return model


def robot_of(model: Any, actuators: dict[str, Any] | None = None, *, floating: bool = False, **limits: Any) -> Robot:
    """A Robot around a model; actuators default to ideal ones that nothing saturates."""
    spec: dict[str, Any] = {
        "joints": {"effort": 1e6},
        "base_torque": {"kind": "ideal", "limit": (1e6,) * 3},
        "base_force": None if floating else {"kind": "thrusters", "limit": (1e6,) * 3},
    }
    names = tuple(model.names[2:])
    full = np.full(len(names), 1e9)
    actuators_spec = Actuators.model_validate(spec | (actuators or {}))
    effort = actuators_spec.joints.effort
    return Robot(
        name="test",
        urdf="",
        model=model,
        joint_names=names,
        body_names=("base_link", *(f"{name}_body" for name in names)),
        base_mode="free_floating" if floating else "free_flying",
        actuators=actuators_spec,
        effort_limit=np.full(len(names), effort) if isinstance(effort, float) else np.array(effort),
        joint_lower=limits.get("lower", -full),
        joint_upper=limits.get("upper", full),
        joint_rate_limit=full,
        home=np.zeros(len(names)),
    )


def random_state(rng: np.random.Generator, joints: int, speed: float = 1.0) -> tuple[Vector, Vector]:
    """A configuration and a velocity."""
    q = np.concatenate([rng.normal(size=3), _unit(rng.normal(size=4)), rng.uniform(-2.0, 2.0, size=joints)])
    return q, rng.normal(size=6 + joints) * speed


def _unit(a: Vector) -> Vector:
    return a / np.linalg.norm(a)
