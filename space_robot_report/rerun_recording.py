"""A log as a Rerun recording with its blueprint: the robot in 3-D, every signal by name, modes and events."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin
import rerun as rr
import rerun.blueprint as rrb

from space_robot_bringup.logs.assessed import JudgedLog
from space_robot_bringup.logs.foreign_log import COMMAND, REFERENCE
from space_robot_description.rotations import to_rpy
from space_robot_description.triangles import triangles_of
from space_robot_description.visual import Look, look_of
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.interfaces import Vector
from space_robot_report.block_names import AXES, block_names
from space_robot_report.playback import Footage

RPY = ("roll", "pitch", "yaw")
TIMELINE = "time"
LEVELS = {"info": "INFO", "low": "INFO", "medium": "WARN", "high": "ERROR"}


def write_rerun(judged: JudgedLog, out: Path, meshes: Sequence[Path] = ()) -> tuple[str, ...]:
    """Write a log as an ``.rrd`` file, which ``rerun FILE`` opens.

    Args:
        judged: see ``read_shown``.
        out: the file.
        meshes: folders the robot's meshes may be read from, see ``look_of``.

    Returns:
        What is missing, a line each.

    Raises:
        LogError: the file cannot be written.
    """
    recording = rr.RecordingStream("space_robot", recording_id=judged.path.stem)
    try:
        out.touch()
        recording.save(str(out), default_blueprint=_blueprint(judged))
    except (OSError, RuntimeError) as error:
        raise LogError(f"the recording cannot be written: {error}", key=str(out)) from None
    troubles = _robot(recording, judged, meshes)
    for path, values in _signals(judged):
        index = [rr.TimeColumn(TIMELINE, duration=judged.arrays.time)]
        recording.send_columns(rr.new_entity_path(list(path)), index, rr.Scalars.columns(scalars=values))
    _events(recording, judged)
    recording.disconnect()
    return (*judged.troubles, *troubles)


def _signals(judged: JudgedLog) -> Iterator[tuple[tuple[str, ...], Vector]]:
    """Every number over time under a path of names, in degrees where it is an attitude."""
    arrays, joints = judged.arrays, judged.header.joint_names
    tables = [("attitude [deg]", "measured", RPY, _attitude(arrays.q)), ("joints", "measured", joints, arrays.q[:, 7:])]
    if REFERENCE not in judged.absent:
        tables += [("attitude [deg]", "desired", RPY, _attitude(arrays.q_d))]
        tables += [("joints", "desired", joints, arrays.q_d[:, 7:])]
    if COMMAND not in judged.absent:
        tables += [("base torque [N m]", "commanded", AXES, arrays.wrench[:, 3:])]
        tables += [("joint effort", "commanded", joints, arrays.effort_command)]
    for title, kind, names, values in tables:
        yield from (((title, kind, name), values[:, index]) for index, name in enumerate(names))
    for side, blocks in (("controller", arrays.controller), ("plant", arrays.plant)):
        for label, block in blocks.items():
            names = block_names(block.shape[1], joints) if block.shape[1] else ()
            yield from ((tuple(filter(None, (side, label, name))), block[:, i]) for i, name in enumerate(names))


def _attitude(q: Vector) -> Vector:
    return np.degrees(np.unwrap([to_rpy(row[3:7]) for row in q], axis=0))


def _robot(recording: rr.RecordingStream, judged: JudgedLog, meshes: Sequence[Path]) -> list[str]:
    """The shapes of the robot once, and where its bodies are at every tick; what is missing, a line each."""
    try:
        look = look_of(judged.header.urdf, meshes)
    except SpaceRobotError as error:
        return [f"no robot in 3-D: {error}"]
    film = Footage.of(judged.arrays)
    if look.model.nq != film.q.shape[1]:
        return ["no robot in 3-D: the robot in the log has other joints than its states"]
    for number, shape in enumerate(look.visuals.geometryObjects):
        mesh = triangles_of(shape.geometry)
        if mesh is not None:
            placed = mesh[0] @ shape.placement.rotation.T + shape.placement.translation
            color = [float(part) for part in shape.meshColor]
            drawn = rr.Mesh3D(vertex_positions=placed, triangle_indices=mesh[1], albedo_factor=color)
            recording.log(rr.new_entity_path([*_body(look, shape.parentJoint), str(number)]), drawn, static=True)
    places = _places(look, film.q)
    index = [rr.TimeColumn(TIMELINE, duration=film.time)]
    for joint in range(1, look.model.njoints):
        pose = places[:, joint - 1]
        columns = rr.Transform3D.columns(translation=pose[:, :3], quaternion=pose[:, 3:])
        recording.send_columns(rr.new_entity_path(list(_body(look, joint))), index, columns)
    return [f"drawn without {uri}" for uri in look.missing]


def _body(look: Look, joint: int) -> tuple[str, str]:
    return "robot", str(look.model.names[joint])


def _places(look: Look, configurations: Vector) -> Vector:
    """(K, bodies, 7) positions and quaternions x, y, z, w in the inertial frame."""
    data, found = look.model.createData(), []
    for q in configurations:
        pin.forwardKinematics(look.model, data, q)
        found.append([pin.SE3ToXYZQUAT(placement) for placement in data.oMi[1:]])
    return np.array(found)


def _events(recording: rr.RecordingStream, judged: JudgedLog) -> None:
    for event in judged.happened:
        recording.set_time(TIMELINE, duration=event.time)
        text = " ".join(part for part in (event.source, event.name, event.message) if part)
        recording.log("happened/events", rr.TextLog(text, level=LEVELS.get(event.severity, "INFO")))
    for span in judged.spans.modes:
        recording.set_time(TIMELINE, duration=span.begin)
        recording.log("happened/modes", rr.TextLog(span.name, level="INFO"))


def _blueprint(judged: JudgedLog) -> rrb.Blueprint:
    """The robot on the left, motion and torques on the right, telemetry behind them, events below."""
    plots = ["attitude [deg]", "joints", *(["base torque [N m]", "joint effort"] * (COMMAND not in judged.absent))]
    motion = rrb.Vertical(*(_plot([title], title) for title in plots), name="Motion")
    sides = (("controller", judged.arrays.controller), ("plant", judged.arrays.plant))
    tabs = [
        rrb.Grid(*(_plot([side, label], label) for label, block in blocks.items() if block.shape[1]), name=side)
        for side, blocks in sides
        if blocks
    ]
    robot = rrb.Spatial3DView(origin="/robot", name="Robot")
    happened = rrb.TextLogView(origin="/happened", name="Events and modes")
    left = rrb.Vertical(robot, happened, row_shares=[4, 1])
    return rrb.Blueprint(rrb.Horizontal(left, rrb.Tabs(motion, *tabs)), collapse_panels=True)


def _plot(path: Sequence[str], title: str) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(origin=rr.new_entity_path(list(path)), name=title)
