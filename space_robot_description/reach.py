"""How far the arm gets: an upper bound from link lengths and a lower bound from sampled postures."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import dist

import numpy as np
import pinocchio as pin

from space_robot_description.kernel.joints import joint_axes
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.mimic import Mimic

SAMPLES = 2000
SEED = 20230517
# Of a distance, by which two ways to reckon it may differ.
ROUND_OFF = 1e-9


@dataclass(frozen=True, slots=True)
class Reach:
    """Largest distance of the tool from the first joint of its chain [m]; the truth lies between the two.

    Attributes:
        sum_bound: distances between successive joint origins added up, prismatic joints at full travel: never exceeded
            (infinite with an unlimited prismatic joint).
        sampled: found among 2000 uniform postures inside the joint limits and at home, then improved joint by joint.
    """

    sum_bound: float
    sampled: float


def reach_of(robot: Robot, link: str = "") -> Reach:
    """Reach of a link, by default of ``robot.tool_frame``; deterministic."""
    robot = replace(robot, tool_frame=link or robot.tool_frame)
    chain = chain_of(robot)
    if not chain:
        return Reach(0.0, 0.0)
    return Reach(_sum_bound(robot, chain), _sampled(robot, chain))


def _tool(robot: Robot) -> tuple[int, Vector]:
    frame = robot.model.frames[robot.model.getFrameId(robot.tool_frame, pin.FrameType.BODY)]
    return int(frame.parentJoint), frame.placement.translation


def chain_of(robot: Robot) -> list[int]:
    """Model indices of the joints from the arm's root to the tool."""
    index, chain = _tool(robot)[0], []
    while index > 1:
        chain.append(index)
        index = int(robot.model.parents[index])
    return chain[::-1]


def _sum_bound(robot: Robot, chain: list[int]) -> float:
    steps = [robot.model.jointPlacements[index].translation for index in chain[1:]]
    total = float(sum(np.linalg.norm(step) for step in [*steps, _tool(robot)[1]]))
    _, slides = joint_axes(robot.model)
    for index in [index for index in chain if slides[index - 2]]:
        mimic = robot.mimics.get(robot.model.names[index], Mimic("", 1.0, 0.0))
        coordinate = robot.model.joints[index].idx_v - 6
        lower, upper = float(robot.joint_lower[coordinate]), float(robot.joint_upper[coordinate])
        total += max(abs(mimic.multiplier * end + mimic.offset) for end in (lower, upper))
    return total


def _sampled(robot: Robot, chain: list[int]) -> float:
    lower = np.maximum(robot.joint_lower, -np.pi)
    upper = np.minimum(robot.joint_upper, np.pi)
    # Limits that lie beyond a turn or on one side of it: keep the interval, sample the first turn of it.
    lower, upper = np.minimum(lower, robot.joint_upper), np.maximum(upper, robot.joint_lower)
    postures = np.random.default_rng(SEED).uniform(lower, upper, size=(SAMPLES, robot.n))
    distances = Distances(robot, chain)
    best = distances.farthest(np.vstack([robot.home, postures]))
    for _ in range(2):
        for index in dict.fromkeys(robot.model.joints[joint].idx_v - 6 for joint in chain):
            trials = np.tile(best, (74, 1))
            trials[1:, index] = np.linspace(lower[index], upper[index], 73)
            best = distances.farthest(trials)
    return distances(best)


class Distances:
    """Distance of the tool from the origin of the first joint [m], as a function of the joint positions.

    Args:
        robot: with its tool.
        chain: see ``chain_of``.
    """

    def __init__(self, robot: Robot, chain: list[int]) -> None:
        self._model, self._data, first = robot.model, robot.model.createData(), chain[0]
        self._joint, self._offset = _tool(robot)
        self._steps = _steps(robot, chain)
        self._q = pin.neutral(robot.model)
        pin.forwardKinematics(self._model, self._data, self._q)
        # A first joint that slides takes its frame along; its placement on the base stands still.
        base = self._data.oMi[self._model.parents[first]]
        self._root = base.act(self._model.jointPlacements[first].translation)

    def __call__(self, joints: Vector) -> float:
        """The distance at (n,) joint positions."""
        self._q[7:] = joints
        pin.forwardKinematics(self._model, self._data, self._q)
        return dist(self._data.oMi[self._joint].act(self._offset), self._root)

    def farthest(self, postures: Vector) -> Vector:
        """The first of the postures (S, n) at which the distance is largest."""
        rough = self.of_all(postures)
        # To ask Pinocchio of each takes as long as to load it; of those that round-off cannot tell apart, it decides.
        near = postures[rough >= rough.max() - ROUND_OFF * (1.0 + rough.max())]
        return max(near, key=self)

    def of_all(self, postures: Vector) -> Vector:
        """(S,) the distance at each of the postures (S, n), but for round-off [m]."""
        arm = np.tile(self._offset, (len(postures), 1))
        for step in self._steps:
            arm = step.before + step.moved(arm, postures) @ step.turn.T
        found: Vector = np.linalg.norm(arm, axis=1)
        return found


@dataclass(frozen=True, slots=True, eq=False)
class _Step:
    """A joint of the chain: its coordinate, what moves it of that, its axis, and where it stands on the one before."""

    coordinate: int
    mimic: Mimic
    axis: Vector
    slides: bool
    turn: Vector
    before: Vector

    def moved(self, arm: Vector, postures: Vector) -> Vector:
        """The points (S, 3) of the moved body in the axes of the joint at rest, by Rodrigues' formula."""
        value = (self.mimic.multiplier * postures[:, self.coordinate] + self.mimic.offset)[:, None]
        if self.slides:
            return arm + value * self.axis
        along = (arm @ self.axis)[:, None] * self.axis
        x, y, z = self.axis
        across = arm @ np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
        turned: Vector = (arm - along) * np.cos(value) + across * np.sin(value) + along
        return turned


def _steps(robot: Robot, chain: list[int]) -> list[_Step]:
    """From the tool to the first joint, whose own place counts for nothing."""
    axes, slides = joint_axes(robot.model)
    steps = []
    for index in chain[::-1]:
        place = robot.model.jointPlacements[index]
        turn, before = (np.eye(3), np.zeros(3)) if index == chain[0] else (place.rotation, place.translation)
        mimic = robot.mimics.get(robot.model.names[index], Mimic("", 1.0, 0.0))
        coordinate = robot.model.joints[index].idx_v - 6
        steps.append(_Step(coordinate, mimic, axes[index - 2], bool(slides[index - 2]), turn, before))
    return steps
