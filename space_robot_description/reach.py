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
    chain = _chain(robot)
    if not chain:
        return Reach(0.0, 0.0)
    return Reach(_sum_bound(robot, chain), _sampled(robot, chain))


def _tool(robot: Robot) -> tuple[int, Vector]:
    frame = robot.model.frames[robot.model.getFrameId(robot.tool_frame, pin.FrameType.BODY)]
    return int(frame.parentJoint), frame.placement.translation


def _chain(robot: Robot) -> list[int]:
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
    distances = _Distances(robot, chain[0])
    candidates = [robot.home.copy(), *postures]
    best = max(candidates, key=distances)
    for _ in range(2):
        for index in dict.fromkeys(robot.model.joints[joint].idx_v - 6 for joint in chain):
            trials = [best]
            for value in np.linspace(lower[index], upper[index], 73):
                trial = best.copy()
                trial[index] = value
                trials.append(trial)
            best = max(trials, key=distances)
    return distances(best)


class _Distances:
    """Distance of the tool from the origin of the first joint, as a function of the joint positions."""

    def __init__(self, robot: Robot, first: int) -> None:
        self._model, self._data = robot.model, robot.model.createData()
        self._joint, self._offset = _tool(robot)
        self._q = pin.neutral(robot.model)
        pin.forwardKinematics(self._model, self._data, self._q)
        # A first joint that slides takes its frame along; its placement on the base stands still.
        base = self._data.oMi[self._model.parents[first]]
        self._root = base.act(self._model.jointPlacements[first].translation)

    def __call__(self, joints: Vector) -> float:
        self._q[7:] = joints
        pin.forwardKinematics(self._model, self._data, self._q)
        return dist(self._data.oMi[self._joint].act(self._offset), self._root)
