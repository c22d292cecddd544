"""Signals by name: what of a log can be drawn or measured, and what it is called."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.judge.metrics import Matrix, axis_names, deviations
from space_robot_control.references.tool_kinematics import tool_pose
from space_robot_description.inertia import inertial_parameters
from space_robot_description.robot import Robot
from space_robot_description.rotations import log, relative, rotate, to_rpy
from space_robot_msgs_py.errors import NonFiniteError, SpaceRobotError
from space_robot_msgs_py.interfaces import PlantSample, Vector
from space_robot_msgs_py.log.arrays import LogArrays
from space_robot_studies.reproduce.attitude_path import axis_distances, path_ratios

PARAMETERS = ("m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
AXIS_FIELDS = ("value", "reference", "error", "rate")
# Of inertial parameters; the last two are known where the law tells its estimate.
KINDS = ("truth", "prior", "estimate", "mismatch")
TOTALS = ("base.error", "base.position_error", "joints.error")
# How directly the base turns to its last reference, and what became of the tool.
PATHS, TOOL = ("base.axis_distance", "base.path"), ("tool.position_error", "tool.attitude_error")
# The block of a law's telemetry that holds its inertial parameters, body by body in the order of PARAMETERS.
ESTIMATE = "parameters"


def signal_names(composition: Composition, *, answered: bool = True) -> tuple[list[str], bool]:
    """Every name that ``Signals.of`` knows for runs of this composition, and whether the law said what it shows.

    With ``answered`` False the law is not asked.

    - ``<axis>.value | reference | error``, axes as in the metrics, ``base/x`` to ``base/z`` of every robot [deg or m];
    - ``<axis>.rate``: velocity in inertial axes, angular velocity in body axes [deg/s or m/s];
    - ``base.error`` (angle), ``joints.error`` (largest of those that turn) [deg], ``base.position_error`` [m];
    - ``base.axis_distance`` [-] and ``base.path`` [-] so far, see ``attitude_path``; NaN where there is no axis, or no
      geodesic; ``tool.position_error`` [m], ``tool.attitude_error`` [deg] of a robot that has a tool;
    - ``base.error_quaternion`` (vector part, inertial axes), ``command.force | torque | effort``,
      ``controller.<label>``, ``plant.<label>``: the norm, or one element ``[i]``;
    - ``truth | prior | estimate | mismatch/<body>/<parameter>``: of the true robot (a capture changes it), the
      nominal one, the law's telemetry, and estimate minus truth.

    A law that has no answer even to the first state shows nothing; the names of its telemetry are not known then.
    """
    sample = composition.plant().reset()
    blocks = {"command.force": 3, "command.torque": 3, "command.effort": composition.nominal.n}
    blocks["base.error_quaternion"] = 3
    blocks |= {f"plant.{label}": block.size for label, block in sample.telemetry.items()}
    law = _first_answer(composition, sample) if answered else None
    shown = law or {}
    blocks |= {f"controller.{label}": block.size for label, block in shown.items()}
    names = [f"{axis}.{field}" for axis in _axes(composition) for field in AXIS_FIELDS]
    names += [*TOTALS, *PATHS, *(TOOL if composition.truth.tool_frame else ())]
    for label, size in blocks.items():
        names += [label, *(f"{label}[{index}]" for index in range(size))]
    bodies = composition.nominal.body_names
    adapts = ESTIMATE in shown and shown[ESTIMATE].size == len(PARAMETERS) * len(bodies)
    kinds = KINDS if adapts else KINDS[:2]
    names += [f"{kind}/{body}/{name}" for kind in kinds for body in bodies for name in PARAMETERS]
    return names, law is not None


def _first_answer(composition: Composition, sample: PlantSample) -> dict[str, Vector] | None:
    """The law's telemetry at the first state; None if it has no answer even to that."""
    try:
        output = composition.controller().update(sample.state, composition.reference().at(0))
    except SpaceRobotError:
        return None
    return dict(output.telemetry.items())


@dataclass(frozen=True, eq=False)
class Signals:
    """The signals of one run.

    Args:
        arrays: its log; at least one tick.
        composition: what was run.
    """

    arrays: LogArrays
    composition: Composition

    def of(self, name: str) -> Vector:
        """(K,) the signal at every tick; see ``signal_names``.

        Raises:
            KeyError: this run has no such signal.
        """
        if name in TOTALS:
            return self._total(name)
        if name in PATHS:
            return self._path(name)
        if name in TOOL:
            return self._tool[TOOL.index(name)]
        if "/" in name and name.partition("/")[0] in KINDS:
            return self._parameter(*name.split("/"))
        source, _, rest = name.partition(".")
        if source in ("command", "controller", "plant", "base"):
            return self._element(source, rest)
        return self._axis(*name.rsplit(".", 1))

    @cached_property
    def errors(self) -> Matrix:
        """(K, 6+n) actual minus desired of the true motion: position [m], rotation vector [deg], joints [deg or m]."""
        return deviations(self.arrays.plant["true_configuration"], self.arrays.q_d) * self._scale

    @property
    def _scale(self) -> Vector:
        """(6+n,) from SI to what is shown, in the order of the axes."""
        lengths = [True] * 3 + [False] * 3 + list(self.composition.nominal.prismatic)
        scale: Vector = np.where(lengths, 1.0, np.degrees(1.0))
        return scale

    def _total(self, name: str) -> Vector:
        if name == "joints.error":
            turning = 6 + np.flatnonzero(~np.array(self.composition.nominal.prismatic, dtype=bool))
            largest: Vector = np.abs(self.errors[:, turning]).max(axis=1, initial=0.0)
            return largest
        return norms(self.errors[:, 3:6] if name == "base.error" else self.errors[:, :3])

    def _path(self, name: str) -> Vector:
        """NaN where nothing turns, or from the first attitude to the last reference there is no way to go."""
        attitude, goal = self.arrays.plant["true_configuration"][:, 3:7], self.arrays.q_d[-1, 3:7]
        try:
            if name == "base.path":
                return path_ratios(attitude, goal)
            distances, turning = axis_distances(attitude, self.arrays.plant["true_velocity"][:, 3:6], goal)
        except NonFiniteError:
            return np.full(self.arrays.time.size, np.nan)
        return np.where(turning, distances, np.nan)

    @cached_property
    def _tool(self) -> tuple[Vector, Vector]:
        """Errors of the tool, [m] and [deg]."""
        q = self.arrays.plant["true_configuration"]
        position, angle = tool_errors(self.composition.truth, q, self.arrays.q_d)
        return position, np.degrees(angle)

    @cached_property
    def _error_quaternion(self) -> Matrix:
        """(K, 3) vector part of the rotation from the reference to the body, inertial axes, the short way."""
        pairs = zip(self.arrays.plant["true_configuration"][:, 3:7], self.arrays.q_d[:, 3:7], strict=True)
        return np.array([np.array(rotate(q, relative(q_d, q)[:3])) for q, q_d in pairs])

    def _axis(self, axis: str, field: str) -> Vector:
        index = _axes(self.composition).index(axis)
        if field == "error":
            return self.errors[:, index]
        if field == "rate":
            rate: Vector = self._velocity()[:, index] * self._scale[index]
            return rate
        q = self.arrays.plant["true_configuration"] if field == "value" else self.arrays.q_d
        if index < 3:
            return q[:, index]
        if index < 6:
            return np.degrees([to_rpy(row[3:7])[index - 3] for row in q])
        shown: Vector = q[:, index + 1] * self._scale[index]
        return shown

    def _velocity(self) -> Matrix:
        """(K, 6+n) true velocity, linear in inertial axes, angular in body axes, SI."""
        v, q = self.arrays.plant["true_velocity"], self.arrays.plant["true_configuration"]
        linear = np.array([rotate(pose, row) for pose, row in zip(q[:, 3:7], v[:, :3], strict=True)])
        return np.hstack([linear, v[:, 3:]])

    def _element(self, source: str, name: str) -> Vector:
        wrench = self.arrays.wrench
        blocks = {
            "command": {"force": wrench[:, :3], "torque": wrench[:, 3:], "effort": self.arrays.effort_command},
            "controller": self.arrays.controller,
            "plant": self.arrays.plant,
        }
        label, bracket, index = name.removesuffix("]").partition("[")
        block = self._error_quaternion if source == "base" else blocks[source][label]
        return block[:, int(index)] if bracket else norms(block)

    def _parameter(self, kind: str, body: str, parameter: str) -> Vector:
        row, column = self.composition.nominal.body_names.index(body), PARAMETERS.index(parameter)
        if kind == "mismatch":
            return self._parameter("estimate", body, parameter) - self._parameter("truth", body, parameter)
        if kind == "estimate":
            return self.arrays.controller[ESTIMATE][:, row * len(PARAMETERS) + column]
        first = self.composition.truth if kind == "truth" else self.composition.nominal
        values = np.full(self.arrays.time.size, inertial_parameters(first)[row, column])
        for stamp, robot, _ in self.composition.changes if kind == "truth" else ():
            values[self.arrays.stamp >= stamp] = inertial_parameters(robot)[row, column]
        return values


def norms(rows: Matrix) -> Vector:
    """(K,) Euclidean norms of rows."""
    lengths: Vector = np.sqrt(np.sum(rows**2, axis=1))
    return lengths


def _axes(composition: Composition) -> list[str]:
    return axis_names(composition.joint_names, base_translation=True)


def tool_errors(robot: Robot, actual: Matrix, desired: Matrix) -> tuple[Vector, Vector]:
    """Return the distance of the tool from its desired place (K,) [m] and the angle to its desired attitude (K,) [rad].

    Args:
        robot: for the tool frame.
        actual: (K, 7+n) configurations that were [m, -, rad].
        desired: (K, 7+n) desired configurations.
    """
    pairs = [(tool_pose(robot, q), tool_pose(robot, q_d)) for q, q_d in zip(actual, desired, strict=True)]
    position = np.array([np.linalg.norm(pose.position - aim.position) for pose, aim in pairs])
    angle = np.array([np.linalg.norm(log(relative(pose.quaternion, aim.quaternion))) for pose, aim in pairs])
    return position, angle
