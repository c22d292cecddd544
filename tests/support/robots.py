"""Robots made of numbers, for tests and benchmarks: random trees, a fixed seven-joint arm, and their MuJoCo twins."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from space_robot_description.robot import Robot
from space_robot_description.spec import Actuators
from space_robot_msgs_py.mimic import Mimic

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
    moved = list(zip(list(model.joints)[2:], list(model.names)[2:], strict=True))
    names = tuple(name for joint, name in moved if joint.nv)
    mimics = {
        name: Mimic(names[joint.idx_v - 6], joint.extract().scaling, joint.extract().offset)
        for joint, name in moved
        if not joint.nv
    }
    full = np.full(len(names), 1e9)
    actuators_spec = Actuators.model_validate(spec | (actuators or {}))
    effort = actuators_spec.joints.effort
    return Robot(
        name="test",
        urdf="",
        model=model,
        joint_names=names,
        body_names=("base_link", *(f"{name}_body" for _, name in moved)),
        base_mode="free_floating" if floating else "free_flying",
        actuators=actuators_spec,
        effort_limit=np.full(len(names), effort) if isinstance(effort, float) else np.array(effort),
        joint_lower=limits.get("lower", -full),
        joint_upper=limits.get("upper", full),
        joint_rate_limit=full,
        home=np.zeros(len(names)),
        mimics=mimics,
    )


def random_state(rng: np.random.Generator, joints: int, speed: float = 1.0) -> tuple[Vector, Vector]:
    """A configuration and a velocity."""
    q = np.concatenate([rng.normal(size=3), _unit(rng.normal(size=4)), rng.uniform(-2.0, 2.0, size=joints)])
    return q, rng.normal(size=6 + joints) * speed


class LivelyMotion:
    """Computed torque for a free-floating robot whose joints swing.

    Args:
        model: the robot.
        rng: of amplitudes (0.6-1 rad), frequencies (0.1-0.2 Hz times speed) and phases.
        speed: factor on the frequencies.
    """

    def __init__(self, model: Any, rng: np.random.Generator, speed: float = 1.0) -> None:
        self._model, self._data, n = model, model.createData(), model.nv - 6
        self._amplitude, self._phase = rng.uniform(0.6, 1.0, n), rng.uniform(0.0, 6.0, n)
        self._omega = speed * 2.0 * np.pi * rng.uniform(0.1, 0.2, n)

    def desired(self, t: float) -> tuple[Vector, Vector, Vector]:
        """Joint positions, rates and accelerations."""
        angle = self._omega * t + self._phase
        a, w = self._amplitude, self._omega
        return a * np.sin(angle), a * w * np.cos(angle), -a * w**2 * np.sin(angle)

    def start(self) -> tuple[Vector, Vector]:
        """A configuration and a velocity on the motion, with some net momentum."""
        joints, rates, _ = self.desired(0.0)
        return np.array([0, 0, 0, 0, 0, 0, 1.0, *joints]), np.array([0.02, -0.015, 0.01, 0.04, -0.03, 0.02, *rates])

    def effort(self, t: float, q: Vector, v: Vector) -> Vector:
        """Joint efforts that bring the joints to the motion, the base free."""
        joints, rates, _ = self.desired(t)
        # The effort is held for 0.1 s: aim at the acceleration of its middle.
        wanted = self.desired(t + 0.05)[2] + 1.0 * (joints - q[7:]) + 2.0 * (rates - v[6:])
        mass = pin.crba(self._model, self._data, q, pin.Convention.LOCAL)
        mass = np.triu(mass) + np.triu(mass, 1).T
        bias = pin.nonLinearEffects(self._model, self._data, q, v)
        base = -np.linalg.solve(mass[:6, :6], mass[:6, 6:] @ wanted + bias[:6])
        return mass[6:, :6] @ base + mass[6:, 6:] @ wanted + bias[6:]


def _unit(a: Vector) -> Vector:
    return a / np.linalg.norm(a)


def mjcf(model: Any, timestep: float) -> str:
    """The same robot for MuJoCo: free base, no gravity, no contact, RK4."""
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    return (
        f'<mujoco><compiler angle="radian" autolimits="false"/><option gravity="0 0 0" integrator="RK4" '
        f'timestep="{timestep!r}"><flag contact="disable"/></option>'
        f"<worldbody>{_mjcf_body(model, data, 1)}</worldbody></mujoco>"
    )


def _mjcf_body(model: Any, data: Any, index: int) -> str:
    placement, inertia = model.jointPlacements[index], model.inertias[index]
    moment = inertia.inertia
    parts = [
        f'<body name="{model.names[index]}" pos="{_text(placement.translation)}" '
        f'quat="{_text(_wxyz(placement.rotation))}">',
        "<freejoint/>" if index == 1 else _mjcf_joint(model, data, index),
        f'<inertial pos="{_text(inertia.lever)}" mass="{inertia.mass!r}" '
        f'fullinertia="{_text([*np.diag(moment), moment[0, 1], moment[0, 2], moment[1, 2]])}"/>',
    ]
    children = [child for child in range(2, model.njoints) if model.parents[child] == index]
    return "".join([*parts, *(_mjcf_body(model, data, child) for child in children), "</body>"])


def _mjcf_joint(model: Any, data: Any, index: int) -> str:
    column = pin.getJointJacobian(model, data, index, pin.LOCAL)[:, model.joints[index].idx_v]
    kind, axis = ("slide", column[:3]) if column[:3].any() else ("hinge", column[3:])
    return f'<joint name="{model.names[index]}_joint" type="{kind}" axis="{_text(axis)}"/>'


def _wxyz(rotation: Vector) -> Vector:
    return np.roll(pin.Quaternion(rotation).coeffs(), 1)


def _text(numbers: Any) -> str:
    return " ".join(repr(float(number)) for number in numbers)


class MujocoTwin:
    """A MuJoCo simulation of a model whose state is read and written in this project's conventions."""

    def __init__(self, model: Any, timestep: float) -> None:
        import mujoco

        self._step = mujoco.mj_step
        self.model = mujoco.MjModel.from_xml_string(mjcf(model, timestep))
        self.data = mujoco.MjData(self.model)
        joints = [self.model.joint(f"{name}_joint") for name in model.names[2:]]
        self._q = np.array([int(joint.qposadr[0]) for joint in joints], dtype=int)
        self._v = np.array([int(joint.dofadr[0]) for joint in joints], dtype=int)

    def set(self, q: Vector, v: Vector) -> None:
        """Set configuration and velocity (MuJoCo: quaternion wxyz, linear velocity in the world frame)."""
        self.data.qpos[:3], self.data.qpos[3:7], self.data.qpos[self._q] = q[:3], np.roll(q[3:7], 1), q[7:]
        self.data.qvel[:3] = pin.Quaternion(np.array(q[3:7])).matrix() @ v[:3]
        self.data.qvel[3:6], self.data.qvel[self._v] = v[3:6], v[6:]

    def step(self, torque: Vector, effort: Vector, steps: int) -> None:
        """Hold a body torque and joint efforts for that many time steps."""
        self.data.qfrc_applied[3:6], self.data.qfrc_applied[self._v] = torque, effort
        self._step(self.model, self.data, steps)

    @property
    def q(self) -> Vector:
        """Configuration with quaternion xyzw."""
        pose = self.data.qpos
        return np.concatenate([pose[:3], np.roll(pose[3:7], -1), pose[self._q]])
