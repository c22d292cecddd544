"""Everything in the scene: the robot, what was desired, torques, the way of the tool, the axes of the base."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pinocchio as pin
import viser

from space_robot_description.triangles import triangles_of
from space_robot_description.visual import Look
from space_robot_msgs_py.interfaces import Vector
from space_robot_report.playback import efforts_by_joint, joint_axes
from space_robot_report.viewer.motion import Moment
from space_robot_report.viewer.visualizer import GhostVisualizer, RobotVisualizer

DESIRED = (0.0, 0.45, 0.7, 0.22)
TORQUE, WAY = (213, 94, 0), (204, 121, 167)
# Arrows shorter than this share of the longest are left out.
MIN_LENGTH = 0.02


class Stage:
    """Shows moments of a run.

    Args:
        server: of viser.
        look: the robot.
        q: (7+n,) its first configuration.
        way: (K, 3) way of the tool [m], see ``draw_way``.
        desired: a robot stands where it was desired, too.

    Attributes:
        size: how far the robot reaches from its base at the start [m].
    """

    def __init__(self, server: viser.ViserServer, look: Look, q: Vector, way: Vector, *, desired: bool = True) -> None:
        self._server = server
        self._start = np.array(q[:3])
        self.size = _reach(look, q)
        self._following = True
        self._axes = joint_axes(look.model)
        scene = server.scene
        scene.set_up_direction("+z")
        # Everything stands in this frame: moving it back by what the base has moved keeps the base in sight.
        self._world = scene.add_frame("world", show_axes=False)
        self._robot = RobotVisualizer(look.model, pin.GeometryModel(), look.visuals)
        self._ghost = GhostVisualizer(look.model, pin.GeometryModel(), look.visuals)
        for visualizer, root, color in ((self._robot, "world/robot", None), (self._ghost, "world/desired", DESIRED)):
            visualizer.initViewer(viewer=server)
            visualizer.loadViewerModel(root, visual_color=color, frame_axis_length=0.15 * self.size)
        self._ghost.visualRootFrame.visible = desired
        self._desired = desired
        # A robot without visuals is at least its frames.
        self._robot.displayFrames(not look.visuals.geometryObjects)
        axes = {"axes_length": 0.75 * self.size, "axes_radius": 0.02 * self.size}
        self._base = scene.add_frame("world/base axes", **axes)
        self._torques = scene.add_arrows("world/torques", np.zeros((1, 2, 3)), TORQUE, **self._arrow)
        self._way = scene.add_line_segments("world/way", _pieces(way), WAY, thickness=0.012 * self.size)
        self._add_grid()
        server.initial_camera.look_at = tuple(self._start)
        server.initial_camera.position = tuple(self._start + self.size * np.array([1.7, -2.1, 1.2]))

    def switches(self) -> dict[str, Callable[[bool], None]]:
        """What can be switched on and off, by label."""
        ghost = {"desired": partial(setattr, self._ghost.visualRootFrame, "visible")} if self._desired else {}
        return ghost | {
            "torques": partial(setattr, self._torques, "visible"),
            "way of the tool": partial(setattr, self._way, "visible"),
            "base axes": partial(setattr, self._base, "visible"),
            "follow the base": self._follow,
        }

    def show(self, moment: Moment) -> None:
        """Place everything; clients see it at once."""
        with self._server.atomic():
            self._ghost.display(moment.q_d)
            self._robot.display(moment.q)
            placement = self._robot.data.oMi[1]
            self._base.position = placement.translation
            self._base.wxyz = pin.Quaternion(placement.rotation).coeffs()[[3, 0, 1, 2]]
            self._torques.points = self._arrows(moment)
            self._place_world()
        self._server.flush()

    def draw_way(self, way: Vector) -> None:
        """Draw another way of the tool, (K, 3) [m], inertial frame; at least one place."""
        self._way.points = _pieces(way)

    def _follow(self, following: bool) -> None:
        self._following = following
        self._place_world()

    def _place_world(self) -> None:
        moved = self._robot.data.oMi[1].translation - self._start
        self._world.position = -moved if self._following else np.zeros(3)

    def _add_grid(self) -> None:
        extent, below = 20.0 * self.size, tuple(self._start - np.array([0.0, 0.0, 1.3 * self.size]))
        look = {"cell_size": 0.5 * self.size, "section_size": 2.5 * self.size, "section_color": (200, 200, 200)}
        self._server.scene.add_grid("world/grid", extent, extent, shadow_opacity=0.0, position=below, **look)

    @property
    def _arrow(self) -> dict[str, float]:
        size = self.size
        return {"shaft_radius": 0.02 * size, "head_radius": 0.05 * size, "head_length": 0.12 * size}

    def _arrows(self, moment: Moment) -> Vector:
        """(N, 2, 3) ends of the arrows: the torque on the base, and the effort of every joint along its axis."""
        placements, arrows = self._robot.data.oMi, []
        base = placements[1]
        arrows.append((base.translation, 1.1 * self.size * base.rotation @ moment.torque))
        efforts = efforts_by_joint(self._robot.model, moment.efforts)
        for joint, (axis, effort) in enumerate(zip(self._axes, efforts, strict=True), start=2):
            place = placements[joint]
            arrows.append((place.translation, 0.6 * self.size * effort * place.rotation @ axis))
        long = [(at, at + push) for at, push in arrows if np.linalg.norm(push) > MIN_LENGTH * self.size]
        # viser wants at least one.
        return np.array(long or [(base.translation, base.translation)])


def _pieces(way: Vector) -> Vector:
    """(N, 2, 3) ends of the lines of a way."""
    return np.stack([way[:-1], way[1:]], axis=1) if len(way) > 1 else np.stack([way, way], axis=1)


def _reach(look: Look, q: Vector) -> float:
    data, shapes = look.model.createData(), look.visuals.createData()
    pin.updateGeometryPlacements(look.model, data, look.visuals, shapes, q)
    far = max((float(np.linalg.norm(placement.translation - q[:3])) for placement in data.oMi[2:]), default=0.1)
    for shape, placement in zip(look.visuals.geometryObjects, shapes.oMg, strict=True):
        mesh = triangles_of(shape.geometry)
        if mesh is not None:
            placed = mesh[0] @ placement.rotation.T + placement.translation - q[:3]
            far = max(far, float(np.linalg.norm(placed, axis=1).max()))
    return far
