"""Pinocchio's visualiser for viser, with meshes no browser chokes on, and robots of one color to see through."""

from __future__ import annotations

from typing import Any

from pinocchio.visualize import ViserVisualizer

from space_robot_description.triangles import triangles_of


class RobotVisualizer(ViserVisualizer):  # type: ignore[misc]
    """A robot in its own colors; a mesh that trimesh cannot read is drawn from the triangles Pinocchio has."""

    def loadViewerGeometryObject(self, geometry_object: Any, prefix: str = "", color: Any = None) -> None:
        """Show one visual."""
        try:
            super().loadViewerGeometryObject(geometry_object, prefix, color)
        except (ValueError, RuntimeError, OSError, ImportError, AttributeError):
            add_triangles(self, geometry_object, prefix, geometry_object.meshColor)
        shown = self.frames[f"{prefix}/{geometry_object.name}"]
        # An opacity of 1 is drawn with the transparent things, in an order that shows what is inside.
        if getattr(shown, "opacity", None) == 1.0:
            shown.opacity = None


class GhostVisualizer(ViserVisualizer):  # type: ignore[misc]
    """A robot one can see through: meshes come without the colors of their files."""

    def loadViewerGeometryObject(self, geometry_object: Any, prefix: str = "", color: Any = None) -> None:
        """Show one visual in the color given."""
        add_triangles(self, geometry_object, prefix, color)


def add_triangles(visualizer: Any, geometry: Any, prefix: str, color: Any) -> None:
    """Show the triangles of a visual in one color (r, g, b, opacity)."""
    mesh = triangles_of(geometry.geometry)
    name = f"{prefix}/{geometry.name}"
    if mesh is None:
        visualizer.frames[name] = visualizer.viewer.scene.add_frame(name, show_axes=False)
        return
    opacity = None if color[3] >= 1.0 else float(color[3])
    visualizer.frames[name] = visualizer.viewer.scene.add_mesh_simple(
        name, *mesh, color=tuple(color[:3]), opacity=opacity, flat_shading=True, side="double", cast_shadow=False
    )
