"""A run in space, ready to be played: the robot's shapes once, and where its bodies are over time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_description.triangles import triangles_of
from space_robot_description.visual import Look
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.log.arrays import LogArrays
from space_robot_report.pages.plots import packed
from space_robot_report.playback import Footage, efforts_by_joint, joint_axes, way_of

# The page turns smoothly between these; more would not be seen.
MAX_FRAMES = 900


def scene(look: Look, arrays: LogArrays, tool: str) -> dict[str, Any]:
    """What ``playback.js`` draws.

    Args:
        look: the robot.
        arrays: its log.
        tool: the link whose way is drawn.

    Returns:
        ``parts`` (triangles in the frame of a body, with color), ``time`` (M,) [s], ``poses`` and ``ghost`` (M, bodies,
        7) positions and quaternions of true and desired bodies in the inertial frame, ``trail`` (M, 3) of the tool,
        ``torque`` (M, 3) on the base in its frame and ``efforts`` (M, N) with the ``axes`` (N, 3) they act about, each
        over the largest of the run.
    """
    film = Footage.of(arrays)
    frames = np.unique(np.linspace(0, film.time.size - 1, MAX_FRAMES).astype(int))
    link = tool if look.model.existFrame(tool, pin.FrameType.BODY) else look.tool
    return {
        "parts": _parts(look),
        "bodies": look.model.njoints - 1,
        "time": packed(film.time[frames], "f8"),
        "poses": packed(_placements(look, film.q[frames]), "f4"),
        "ghost": packed(_placements(look, film.q_d[frames]), "f4"),
        "trail": packed(way_of(look.model, film.q[frames], link), "f4"),
        "torque": packed(film.torque[frames], "f4"),
        "efforts": packed(efforts_by_joint(look.model, film.efforts[frames]), "f4"),
        "axes": packed(joint_axes(look.model), "f4"),
    }


def _placements(look: Look, configurations: Vector) -> Vector:
    """(M, bodies, 7) placements of the bodies."""
    data = look.model.createData()
    poses = []
    for q in configurations:
        pin.forwardKinematics(look.model, data, q)
        poses.append([pin.SE3ToXYZQUAT(placement) for placement in data.oMi[1:]])
    return np.array(poses)


def _parts(look: Look) -> list[dict[str, Any]]:
    parts = []
    for shape in look.visuals.geometryObjects:
        mesh = triangles_of(shape.geometry)
        if mesh is None:
            continue
        vertices, faces = mesh
        placed = vertices @ shape.placement.rotation.T + shape.placement.translation
        parts.append(
            {
                "body": int(shape.parentJoint) - 1,
                "color": [round(float(part), 3) for part in shape.meshColor],
                "vertices": packed(placed, "f4"),
                "faces": packed(faces, "u2"),
            }
        )
    return parts or _sticks(look.model)


def _sticks(model: Any) -> list[dict[str, Any]]:
    """A robot without visuals: a stick from each joint to the next."""
    parts = []
    for joint in range(2, model.njoints):
        end = model.jointPlacements[joint].translation
        length = float(np.linalg.norm(end))
        if length < 1e-6:
            continue
        across = np.cross(end, np.eye(3)[int(np.argmin(np.abs(end)))])
        across *= 0.04 * length / float(np.linalg.norm(across))
        vertices = [-across, across, end + across, end - across]
        turned = np.cross(end / length, across)
        vertices += [-turned, turned, end + turned, end - turned]
        faces = [(0, 1, 2), (0, 2, 3), (4, 5, 6), (4, 6, 7)]
        parts.append(
            {
                "body": int(model.parents[joint]) - 1,
                "color": [0.5, 0.5, 0.55, 1.0],
                "vertices": packed(vertices, "f4"),
                "faces": packed(faces, "u2"),
            }
        )
    return parts
