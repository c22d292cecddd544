import os

import coal
import numpy as np
import pytest

from space_robot_description.load import load_robot
from space_robot_description.share import shipped
from space_robot_description.triangles import simplified, triangles_of
from space_robot_description.visual import look_of

LINK = """<link name="{name}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
</inertial>{visual}</link>"""
JOINT = """<joint name="hinge" type="continuous"><axis xyz="0 0 1"/><parent link="base_link"/><child link="arm"/>
</joint>"""


TRIANGLE = """solid arm
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid arm
"""


def urdf(visual):
    links = LINK.format(name="base_link", visual="") + LINK.format(name="arm", visual=visual)
    return f"<robot name='r'>{links}{JOINT}</robot>"


@pytest.mark.parametrize("name", shipped("robots"))
def test_every_shipped_robot_has_a_look(name):
    """Every visual of every shipped robot is found, has a name of its own and becomes triangles of its body."""
    robot = load_robot(name)
    look = look_of(robot.urdf)
    shapes = list(look.visuals.geometryObjects)
    assert look.missing == ()
    assert shapes
    assert len({shape.name for shape in shapes}) == len(shapes)
    for shape in shapes:
        vertices, faces = triangles_of(shape.geometry)
        assert np.isfinite(vertices).all()
        assert 0 <= faces.min() <= faces.max() < len(vertices)


def test_a_mesh_that_is_not_there_costs_only_its_visual():
    """A missing mesh is named, and the shapes beside it are drawn."""
    mesh = '<visual><geometry><mesh filename="package://nowhere/arm.stl"/></geometry></visual>'
    box = '<visual><geometry><box size="1 2 3"/></geometry></visual>'
    look = look_of(urdf(mesh + box))
    assert look.missing == ("package://nowhere/arm.stl",)
    (shape,) = look.visuals.geometryObjects
    assert shape.geometry.halfSide.tolist() == [0.5, 1.0, 1.5]


def test_a_mesh_that_cannot_be_read_is_named(tmp_path):
    """A file that is no mesh is reported, not raised."""
    path = tmp_path / "arm.stl"
    path.write_text("not a mesh")
    look = look_of(urdf(f'<visual><geometry><mesh filename="{path.as_uri()}"/></geometry></visual>'))
    assert look.missing == (path.as_uri(),)


def test_a_log_names_no_mesh_outside_of_what_is_shipped_or_typed(tmp_path):
    """A mesh anywhere else is not read, however the way to it is spelt, but for a folder that the user typed."""
    folder = tmp_path / "meshes"
    folder.mkdir()
    (folder / "arm.stl").write_text(TRIANGLE)
    uri = (folder / "arm.stl").as_uri()
    around = f"package://{'../' * 20}{folder}/arm.stl"
    for name in (uri, str(folder / "arm.stl"), around, f"package:///{folder}/arm.stl"):
        visual = f'<visual><geometry><mesh filename="{name}"/></geometry></visual>'
        assert look_of(urdf(visual)).missing == (name,)
    visual = f'<visual><geometry><mesh filename="{uri}"/></geometry></visual>'
    assert look_of(urdf(visual), [folder]).missing == ()
    assert look_of(urdf(visual), [folder / "other", tmp_path / "mesh"]).missing == (uri,)


@pytest.mark.parametrize("kind", ["pipe", "device", "directory", "two shapes"])
def test_a_mesh_that_is_not_a_file_is_not_opened(tmp_path, kind):
    """A pipe, a device or a directory under the name of a mesh is named, not waited for."""
    path = tmp_path / "arm.stl"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "device":
        path.symlink_to("/dev/zero")
    elif kind == "directory":
        path.mkdir()
    else:
        path.write_text(TRIANGLE)
    shapes = f'<mesh filename="{path.as_uri()}"/><mesh filename="file:///etc/passwd"/>'
    look = look_of(urdf(f"<visual><geometry>{shapes}</geometry></visual>"), [tmp_path])
    assert look.missing == ("file:///etc/passwd" if kind == "two shapes" else path.as_uri(),)


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        (coal.Box(1.0, 2.0, 3.0), 6.0),
        (coal.Cylinder(0.5, 2.0), np.pi * 0.25 * 2.0),
        (coal.Sphere(0.7), 4.0 / 3.0 * np.pi * 0.7**3),
    ],
    ids=["box", "cylinder", "sphere"],
)
def test_triangles_enclose_the_volume_of_the_shape(shape, volume):
    """The surface is closed, its faces look outward, and it holds nearly the volume of the shape."""
    vertices, faces = triangles_of(shape)
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    held = float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)
    assert volume * 0.97 < held <= volume * (1.0 + 1e-12)


def test_simplified_meshes_keep_their_extent():
    """A fine mesh gets few triangles, none of them degenerate, and stays within a cell of where it was."""
    grid = np.stack(np.meshgrid(np.linspace(0, 1, 120), np.linspace(0, 1, 120), indexing="ij"), axis=-1).reshape(-1, 2)
    vertices = np.column_stack([grid, 0.1 * np.sin(6.0 * grid[:, 0])])
    corner = np.array([120 * i + j for i in range(119) for j in range(119)])
    faces = np.vstack(
        [np.column_stack([corner, corner + 1, corner + 120]), np.column_stack([corner + 1, corner + 121, corner + 120])]
    )
    fewer, kept = simplified(vertices, faces, 2500)
    assert 100 < len(kept) <= 2500
    assert all(len(set(face)) == 3 for face in kept.tolist())
    np.testing.assert_allclose(fewer.min(axis=0), vertices.min(axis=0), atol=0.06)
    np.testing.assert_allclose(fewer.max(axis=0), vertices.max(axis=0), atol=0.06)
