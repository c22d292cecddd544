"""Text that is no content changes nothing: comments, other name spaces, encodings; xacro is expanded or refused."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest

from space_robot_description import xacro_file
from space_robot_description.inertia import inertial_parameters
from space_robot_description.load import load_robot
from space_robot_msgs_py.errors import InputFileError, SpecError
from tests.support.description_texts import BOX, TWO_LINKS, joint, link, robot_file, urdf

PLAIN = urdf(*TWO_LINKS)
NO_CONTENT = {
    "comment": PLAIN.replace("<link", "<!-- ${mass} --><link", 1),
    "gazebo": PLAIN.replace("</robot>", '<gazebo><a xmlns:s="urn:s" s:b="${c}"><s:d/></a></gazebo></robot>'),
    "gazebo in a link": PLAIN.replace("</link>", "<gazebo>${c}</gazebo></link>", 1),
    "foreign elements": PLAIN.replace("<inertial>", '<d:props xmlns:d="http://drake.mit.edu"/><inertial>', 1),
    "foreign attributes": PLAIN.replace("<limit", '<limit xmlns:d="http://drake.mit.edu" d:acceleration="5"'),
    "default name space": PLAIN.replace("<robot", '<robot xmlns="http://www.ros.org"'),
    "declared xacro": PLAIN.replace("<robot", '<robot xmlns:xacro="http://wiki.ros.org/xacro"'),
    "processing": PLAIN.replace("<link", "<?note ${x}?><link", 1),
    "other elements": PLAIN.replace("</robot>", '<sensor name="${x}"/></robot>'),
}


@pytest.mark.parametrize("case", NO_CONTENT)
def test_text_that_is_no_content_changes_nothing(case: str) -> None:
    """Comments, simulators' elements and other name spaces are no xacro, and the robot is the same without them."""
    robot = load_robot(robot_file(NO_CONTENT[case]))
    expected = load_robot(robot_file())
    assert inertial_parameters(robot).tobytes() == inertial_parameters(expected).tobytes()
    assert load_robot(robot.resolved).urdf == robot.urdf


@pytest.mark.parametrize(
    "text",
    [
        PLAIN.replace('value="2"', 'value="${m}"', 1),
        PLAIN.replace("</robot>", '<x:macro xmlns:x="http://ros.org/wiki/xacro" name="a"/></robot>'),
    ],
)
def test_xacro_in_a_urdf_is_refused_with_what_to_do(text: str) -> None:
    """What has to be expanded is refused in one line that names both ways to a robot."""
    with pytest.raises(
        SpecError, match=r"xacro in the URDF; got .*accepted: `urdf: FILE\.xacro`.*`xacro FILE"
    ) as error:
        load_robot(robot_file(text))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("tag", ["link", "inertial", "mass", "joint", "axis"])
def test_parts_of_the_robot_in_other_name_spaces_are_refused(tag: str) -> None:
    """A link, a joint or what they are made of is not dropped because of its name space."""
    text = re.sub(rf"<{tag}(?=[ >])", f'<{tag} xmlns="urn:other"', PLAIN, count=1)
    with pytest.raises(SpecError, match=rf"<{tag}> in <\w+> has another name space; got 'urn:other'"):
        load_robot(robot_file(text))


DECLARED = '<?xml version="1.0" encoding="{}"?>'
ENCODINGS = {
    "utf-8": ("", "utf-8"),
    "utf-8 with mark": ("", "utf-8-sig"),
    "utf-16": (DECLARED.format("UTF-16"), "utf-16"),
    "utf-16 without declaration": ("", "utf-16-le"),
    "big endian": ("", "utf-16-be"),
    "latin-1": (DECLARED.format("ISO-8859-1"), "latin-1"),
    "windows": (DECLARED.format("windows-1252"), "cp1252"),
}


@pytest.mark.parametrize("case", ENCODINGS)
def test_declared_encodings_are_read(tmp_path: Path, case: str) -> None:
    """A file in an encoding that XML declares is read, names in it too."""
    head, encoding = ENCODINGS[case]
    text = head + urdf(*TWO_LINKS[:4], joint("höhe", "upper", "fore"))
    (tmp_path / "arm.urdf").write_bytes(text.encode(encoding))
    assert load_robot(robot_file(str(tmp_path / "arm.urdf"))).joint_names == ("j1", "höhe")


BAD_BYTES = {
    "not utf-8": (PLAIN.replace("test", "t\xe9st").encode("latin-1"), "cannot be read as UTF-8 text"),
    "unknown": (DECLARED.format("nonsense").encode() + PLAIN.encode(), "unknown encoding; got 'nonsense'"),
    "no encoding of text": (DECLARED.format("zlib").encode() + PLAIN.encode(), "unknown encoding; got 'zlib'"),
    "idna": (DECLARED.format("idna").encode() + PLAIN.encode(), "unknown encoding; got 'idna'"),
    "document type": (('<!DOCTYPE a [<!ENTITY b "c">]>' + PLAIN).encode("utf-16"), "has a document type"),
}


@pytest.mark.parametrize("case", BAD_BYTES)
def test_bytes_that_are_no_text_are_refused(tmp_path: Path, case: str) -> None:
    """What is not in its encoding, or in none, is one line that names the file."""
    data, message = BAD_BYTES[case]
    (tmp_path / "arm.urdf").write_bytes(data)
    with pytest.raises((SpecError, InputFileError)) as error:
        load_robot(robot_file(str(tmp_path / "arm.urdf")))
    assert message in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("outside", ["<a>", "<gazebo>"])
def test_deep_nesting_is_one_line(outside: str) -> None:
    """3,000 elements in each other are refused by the name of the limit, wherever they stand."""
    tag = outside.strip("<>")
    text = PLAIN.replace("</robot>", f"<{tag}>" * 3000 + f"</{tag}>" * 3000 + "</robot>")
    with pytest.raises(SpecError, match="limit URDF_DEPTH") as error:
        load_robot(robot_file(text))
    assert "\n" not in str(error.value)


XACRO = f"""<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:arg name="mass" default="1"/><xacro:arg name="sensor" default="false"/>
<xacro:macro name="part" params="name"><link name="${{name}}">{BOX.replace('value="2"', 'value="$(arg mass)"')}</link>
</xacro:macro>
<xacro:part name="base_link"/><xacro:part name="upper"/>{joint("j1", "base_link", "upper")}
<xacro:if value="$(arg sensor)">{link("eye")}{joint("j2", "upper", "eye")}</xacro:if>
</robot>"""


def test_xacro_files_are_expanded_with_their_arguments(tmp_path: Path) -> None:
    """`urdf: FILE.xacro` is expanded with `xacro_args`, also booleans; the log needs neither."""
    pytest.importorskip("xacro")
    (tmp_path / "my.urdf.xacro").write_text(XACRO)
    plain = load_robot(robot_file(str(tmp_path / "my.urdf.xacro")))
    assert (plain.n, plain.model.inertias[1].mass) == (1, 1.0)
    robot = load_robot(robot_file(str(tmp_path / "my.urdf.xacro"), xacro_args={"mass": 2.5, "sensor": True}))
    assert (robot.n, robot.model.inertias[1].mass) == (2, 2.5)
    assert "xacro" not in robot.urdf
    assert "xacro_args" not in robot.resolved
    np.testing.assert_array_equal(inertial_parameters(load_robot(robot.resolved)), inertial_parameters(robot))


def test_xacro_errors_are_one_line(tmp_path: Path) -> None:
    """What xacro refuses, what is no argument, and arguments without xacro are one line each."""
    pytest.importorskip("xacro")
    (tmp_path / "my.xacro").write_text(XACRO.replace("${name}", "${nmae}"))
    with pytest.raises(SpecError, match=r"xacro refuses the file: .*nmae.*") as error:
        load_robot(robot_file(str(tmp_path / "my.xacro")))
    assert "\n" not in str(error.value)
    with pytest.raises(SpecError, match=r"xacro_args: no name of a xacro argument; got '--inorder'"):
        load_robot(robot_file(str(tmp_path / "my.xacro"), xacro_args={"--inorder": 1}))
    with pytest.raises(SpecError, match=r"xacro_args: only a xacro file has arguments; got 'URDF text'"):
        load_robot(robot_file(xacro_args={"mass": 1}))
    with pytest.raises(InputFileError, match="no such URDF file"):
        load_robot(robot_file(str(tmp_path / "none.xacro")))


def test_without_xacro_the_advice_is_a_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the extra is not installed, the error says what installs it and what does without it."""
    (tmp_path / "my.urdf.xacro").write_text(XACRO)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(
        SpecError, match=r"not installed; accepted: install space-robot\[xacro\]: pip .*`xacro my\.urdf\.xacro -o FILE"
    ):
        load_robot(robot_file(str(tmp_path / "my.urdf.xacro")))


def test_xacro_that_does_not_end_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file that takes too long is given up."""
    (tmp_path / "my.xacro").write_text(XACRO)
    monkeypatch.setattr(xacro_file, "SECONDS", 0.2)
    monkeypatch.setattr(xacro_file, "_PROGRAM", "while True: pass")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: object())
    with pytest.raises(SpecError, match="xacro takes too long"):
        load_robot(robot_file(str(tmp_path / "my.xacro")))
