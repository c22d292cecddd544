"""The viewer takes every robot: boxes, meshes of any kind, and URDFs that say nothing of their looks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("viser")
trimesh = pytest.importorskip("trimesh")

from space_robot_description.load import load_robot  # noqa: E402
from space_robot_description.share import shipped  # noqa: E402
from space_robot_description.visual import look_of  # noqa: E402
from space_robot_msgs_py.errors import LogError  # noqa: E402
from space_robot_msgs_py.log.writer import LogSink  # noqa: E402
from space_robot_report.playback import Footage  # noqa: E402
from space_robot_report.viewer.load import load_show  # noqa: E402
from space_robot_report.viewer.serve import serve  # noqa: E402
from space_robot_report.viewer.show import Show  # noqa: E402
from tests.support import values  # noqa: E402

pytestmark = pytest.mark.xdist_group("browser")

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
URDF = """<robot name="r"><link name="base_link">{inertial}</link><link name="arm">{inertial}{visual}</link>
<joint name="hinge" type="continuous"><parent link="base_link"/><child link="arm"/><axis xyz="0 0 1"/></joint>
</robot>"""


def served(urdf: str, meshes: Sequence[Path] = ()) -> list[str]:
    """Serve a still robot until everything stands; what was announced."""
    look = look_of(urdf, meshes)
    q = np.array([pin.neutral(look.model)] * 2)
    film = Footage(np.array([0.0, 1.0]), q, q, np.ones((2, 3)), np.ones((2, look.model.nv - 6)))
    announced: list[str] = []
    show = Show(look, film, look.tool, "still", "about")
    serve(show, port=18301, open_browser=False, on_ready=announced.append, stop=lambda: "seen")
    return announced


@pytest.mark.parametrize("name", shipped("robots"))
def test_every_shipped_robot_can_be_served(name: str) -> None:
    """Scene and controls of every shipped robot are built, and the address is announced once."""
    (address,) = served(load_robot(name).urdf)
    assert address.startswith("http://localhost:")


@pytest.mark.parametrize("kind", ["stl", "obj", "dae", "ply"])
def test_meshes_of_users_can_be_served(tmp_path: Path, kind: str) -> None:
    """Meshes in a folder that the user names are shown, whatever their format; without the name they are missing."""
    folder = tmp_path / "my meshes"
    folder.mkdir()
    trimesh.creation.icosphere(subdivisions=2, radius=0.3).export(folder / f"arm.{kind}")
    mesh = f'<visual><geometry><mesh filename="{(folder / f"arm.{kind}").as_uri()}" scale="1 1 2"/></geometry></visual>'
    urdf = URDF.format(inertial=INERTIAL, visual=mesh)
    assert look_of(urdf, [folder]).missing == ()
    assert len(served(urdf, [folder])) == 1
    assert look_of(urdf).missing == ((folder / f"arm.{kind}").as_uri(),)


@pytest.mark.parametrize(
    "visual", ["", '<visual><geometry><mesh filename="package://none/a.stl"/></geometry></visual>']
)
def test_a_robot_without_looks_can_be_served(visual: str) -> None:
    """A robot without visuals, or whose only mesh is missing, is shown by its frames."""
    assert len(served(URDF.format(inertial=INERTIAL, visual=visual))) == 1


def test_a_log_with_another_robot_in_it_is_refused(tmp_path: Path) -> None:
    """States that do not fit the URDF of their log are one clear error, not a picture."""
    header = replace(values.HEADER, experiment="", urdf=URDF.format(inertial=INERTIAL, visual=""))
    sink = LogSink(tmp_path / "run", header)
    for tick in values.run_ticks(3):
        sink.record(tick)
    sink.close("completed")
    with pytest.raises(LogError, match="other joints than its states"):
        load_show(tmp_path / "run")
