"""The wheel carries everything the source tree has: packages, data, ament markers, node executables."""

from __future__ import annotations

import ast
import os
import re
import shlex
import sys
import tomllib
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest

from space_robot_description.validation import parse_yaml_text
from space_robot_msgs_py.topics import TABLE
from tests.support.distribution import ROOT, executables

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
SHARE, DATA = "share/space_robot", f"space_robot-{PROJECT['version']}.data/data"
PARTS = ("msgs_py", "description", "control", "sim", "supervisor", "bringup", "studies", "report", "cli")
PACKAGES = ["space_robot", *(f"space_robot_{name}" for name in PARTS)]
# Where ros2 run and ros2 launch look; the others are ordinary Python packages.
AMENT = [name for name in PACKAGES if (ROOT / "resource" / name).is_file()]


pytestmark = pytest.mark.xdist_group("wheel")


def test_the_wheel_holds_every_module_and_every_config_file(wheel: Path) -> None:
    """A file added to the tree is not forgotten in the installation."""
    held = set(zipfile.ZipFile(wheel).namelist())
    kinds = (".py", ".j2", ".js", ".css", ".json", ".typed", ".txt")
    files = (path for name in PACKAGES for path in (ROOT / name).rglob("*") if path.name.endswith(kinds))
    modules = {path.relative_to(ROOT).as_posix() for path in files}
    config = {
        f"{DATA}/{SHARE}/{path.relative_to(ROOT).as_posix()}" for path in (ROOT / "config").rglob("*") if path.is_file()
    }
    assert config
    assert len(modules) > 100
    assert modules | config <= held, sorted((modules | config) - held)


def test_the_wheel_is_an_ament_package_with_executables(wheel: Path) -> None:
    """Every package has its marker, and the node executables are there and may be executed."""
    archive = zipfile.ZipFile(wheel)
    held = {info.filename: info for info in archive.infolist()}
    assert {"space_robot_sim", "space_robot_control", "space_robot_bringup"} <= set(AMENT)
    for name in AMENT:
        assert f"{DATA}/share/ament_index/resource_index/packages/{name}" in held
        described = ElementTree.fromstring(archive.read(f"{DATA}/share/{name}/package.xml"))
        assert (described.findtext("name"), described.findtext("version")) == (name, PROJECT["version"])
    assert f"{DATA}/{SHARE}/package.xml" in held
    assert {"space_robot_sim/simulator", "space_robot_control/adaptive_controller"} <= set(executables())
    for place in executables():
        info = held[f"{DATA}/lib/{place}"]
        assert info.external_attr >> 16 & 0o111, f"{place} is not executable"


def test_package_xml_names_every_ros_package_that_is_used(monkeypatch: pytest.MonkeyPatch) -> None:
    """What ``rosdep install`` brings is what the nodes import and the topics carry; nothing is forgotten."""
    index = pytest.importorskip("ament_index_python")
    monkeypatch.setenv("AMENT_PREFIX_PATH", os.environ.get("AMENT_PREFIX_PATH", sys.prefix))
    declared = {depend.text for depend in ElementTree.parse(ROOT / "package.xml").iter("exec_depend")}
    files = [file for name in [*PACKAGES, "launch"] for file in (ROOT / name).rglob("*.py")]
    nodes = (node for file in files for node in ast.walk(ast.parse(file.read_text())))
    imported = {module.split(".")[0] for node in nodes for module in _modules(node)}
    known = {*index.get_packages_with_prefixes(), "launch", "launch_ros"}
    assert "rclpy" in imported
    assert imported & known <= declared
    assert {topic.type.split("/")[0] for topic in TABLE} <= declared


def test_the_workspace_instructions_name_every_other_dependency() -> None:
    """What rosdep cannot bring is in the page's pip line, as it is in pyproject; Pinocchio and numpy rosdep brings."""
    others = {name for name in PROJECT["dependencies"] if not name.startswith(("pin>", "numpy>"))}
    page = (ROOT / "docs" / "ros2.md").read_text().splitlines()
    (line,) = (line for line in page if line.startswith("pip install 'numba"))
    assert set(shlex.split(line)[2:]) == others | {"numpy>=1.26,<2"}


def test_there_is_one_version() -> None:
    """The version of pyproject.toml is that of the ROS package, of the citation, and of every wheel a page names."""
    package, citation = ElementTree.parse(ROOT / "package.xml").getroot(), _citation()
    pages = [path.read_text() for path in (ROOT / "README.md", *(ROOT / "docs").rglob("*.md"))]
    named = {found for text in pages for found in re.findall(r"space_robot-(\d[\w.]*)-py3", text)}
    assert {package.findtext("version"), citation["version"], *named} == {PROJECT["version"]}


def test_the_container_file_installs_what_there_is() -> None:
    """Its extras and its command exist; what it ignores is what git ignores."""
    text = (ROOT / "Dockerfile").read_text()
    (extras,) = re.findall(r"'/src\[([\w,]+)\]'", text)
    assert set(extras.split(",")) <= PROJECT["optional-dependencies"].keys()
    (experiment,) = re.findall(r"space-robot run (\S+) --out", text)
    assert (ROOT / "config" / "experiments" / f"{experiment}.yaml").is_file()
    ignored = {line.strip("/") for line in (ROOT / ".gitignore").read_text().split()}
    mine = {line.removeprefix("**/") for line in (ROOT / ".dockerignore").read_text().split()}
    assert mine - {".git", ".*_cache"} <= ignored


def test_there_is_one_license_and_one_address(wheel: Path) -> None:
    """Licence and repository agree in wheel, package.xml and CITATION.cff; the wheel has the text of the licence."""
    name = f"space_robot-{PROJECT['version']}.dist-info"
    archive = zipfile.ZipFile(wheel)
    metadata = archive.read(f"{name}/METADATA").decode().partition("\n\n")[0]
    fields = dict(line.split(": ", 1) for line in metadata.splitlines() if line.startswith("License"))
    assert fields == {"License-Expression": "Apache-2.0", "License-File": "LICENSE"}
    assert archive.read(f"{name}/licenses/LICENSE") == (ROOT / "LICENSE").read_bytes()
    assert ElementTree.parse(ROOT / "package.xml").findtext("license") == _citation()["license"] == "Apache-2.0"
    repository = PROJECT["urls"]["Repository"]
    assert repository == _citation()["repository-code"]
    assert all(address.startswith(repository) for address in PROJECT["urls"].values())


def _citation() -> dict[str, object]:
    return parse_yaml_text((ROOT / "CITATION.cff").read_text(), "CITATION.cff")


def _modules(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    return [node.module] if isinstance(node, ast.ImportFrom) and node.module else []
