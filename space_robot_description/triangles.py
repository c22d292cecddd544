"""Shapes as triangles, few enough for a browser: boxes, cylinders, spheres and meshes."""

from __future__ import annotations

from typing import Any

import coal
import numpy as np
import numpy.typing as npt

from space_robot_msgs_py.interfaces import Vector

SIDES = 28
# Cells along the diagonal of a mesh; finer detail than this is not seen.
CELLS = 56
MAX_TRIANGLES = 2500

Faces = npt.NDArray[np.int64]
Mesh = tuple[Vector, Faces]


def triangles_of(shape: Any) -> Mesh | None:
    """Vertices (V, 3) [m] and faces (F, 3) of a shape in its own frame; None for a kind that has none here.

    Args:
        shape: ``geometry`` of a ``pin.GeometryObject``.
    """
    if isinstance(shape, coal.Box):
        return _box(shape.halfSide)
    if isinstance(shape, coal.Cylinder):
        return _cylinder(shape.radius, shape.halfLength)
    if isinstance(shape, coal.Sphere):
        return _sphere(shape.radius)
    if isinstance(shape, coal.BVHModelBase):
        faces = [shape.tri_indices(index) for index in range(shape.num_tris)]
        return simplified(np.array(shape.vertices()), np.array([(f[0], f[1], f[2]) for f in faces]))
    return None


def simplified(vertices: Vector, faces: Faces, most: int = MAX_TRIANGLES) -> Mesh:
    """The same surface with at most that many triangles: vertices in a common cell become one.

    Args:
        vertices: (V, 3) [m].
        faces: (F, 3) indices.
        most: triangles that may stay; a mesh with fewer is returned as it is.
    """
    if len(faces) <= most:
        return vertices, faces
    low = vertices.min(axis=0)
    diagonal = float(np.linalg.norm(vertices.max(axis=0) - low))
    cells = CELLS
    while True:
        keys = np.floor((vertices - low) / (diagonal / cells)).astype(np.int64)
        _, group = np.unique(keys, axis=0, return_inverse=True)
        group = group.reshape(-1)
        merged = group[faces]
        whole = (merged[:, 0] != merged[:, 1]) & (merged[:, 1] != merged[:, 2]) & (merged[:, 0] != merged[:, 2])
        kept = np.unique(merged[whole], axis=0)
        if len(kept) <= most:
            break
        cells = cells * 3 // 4
    sums = np.zeros((int(group.max()) + 1, 3))
    np.add.at(sums, group, vertices)
    return sums / np.bincount(group)[:, None], kept


def _box(half: Vector) -> Mesh:
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])


def _cylinder(radius: float, half_length: float) -> Mesh:
    """Along z, as URDF has it."""
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    ring = np.column_stack([radius * np.cos(angles), radius * np.sin(angles)])
    rims = [np.column_stack([ring, np.full(SIDES, z)]) for z in (-half_length, half_length)]
    vertices = np.vstack([*rims, [[0.0, 0.0, -half_length], [0.0, 0.0, half_length]]])
    bottom, top = 2 * SIDES, 2 * SIDES + 1
    faces = []
    for i, j in zip(range(SIDES), [*range(1, SIDES), 0], strict=True):
        faces += [(i, j, SIDES + j), (i, SIDES + j, SIDES + i), (bottom, j, i), (top, SIDES + i, SIDES + j)]
    return vertices, np.array(faces)


def _sphere(radius: float) -> Mesh:
    rows, columns = SIDES // 2, SIDES
    polar, azimuth = np.pi * np.arange(rows + 1) / rows, 2.0 * np.pi * np.arange(columns) / columns
    grid = [(np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)) for p in polar for a in azimuth]
    faces = []
    for row in range(rows):
        for i, j in zip(range(columns), [*range(1, columns), 0], strict=True):
            a, b, c, d = row * columns + i, row * columns + j, (row + 1) * columns + i, (row + 1) * columns + j
            faces += [(a, c, d), (a, d, b)]
    return radius * np.array(grid), np.array(faces)
