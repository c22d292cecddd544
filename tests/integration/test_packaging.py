"""The wheel carries everything the source tree has: packages, data, ament markers, node executables."""

from __future__ import annotations

import ast
import os
import shlex
import sys
import tomllib
import zipfile
from xml.etree import ElementTree

import pytest

from space_robot_msgs_py.topics import TABLE
from tests.integration.distribution import ROOT, build_wheel, executables

SHARE, DATA = "share/space_robot", "space_robot-0.1.0.data/data"
PACKAGES = ["space_robot", *(f"space_robot_{name}" for name in ("msgs_py", "description", "control", "sim", "bringup"))]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    return zipfile.ZipFile(build_wheel(tmp_path_factory.mktemp("wheel")))


def test_the_wheel_holds_every_module_and_every_config_file(wheel: zipfile.ZipFile) -> None:
    """A file added to the tree is not forgotten in the installation."""
    held = set(wheel.namelist())
    kinds = (".py", ".j2", ".js", ".css", ".typed")
    files = (path for name in PACKAGES for path in (ROOT / name).rglob("*") if path.name.endswith(kinds))
    modules = {path.relative_to(ROOT).as_posix() for path in files}
    config = {
        f"{DATA}/{SHARE}/{path.relative_to(ROOT).as_posix()}" for path in (ROOT / "config").rglob("*") if path.is_file()
    }
    assert config
    assert modules | config <= held, sorted((modules | config) - held)


def test_the_wheel_is_an_ament_package_with_executables(wheel: zipfile.ZipFile) -> None:
    """Every package has its marker, and the node executables are there and may be executed."""
    held = {info.filename: info for info in wheel.infolist()}
    for name in PACKAGES:
        assert f"{DATA}/share/ament_index/resource_index/packages/{name}" in held
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
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    others = {name for name in declared if not name.startswith(("pin>", "numpy>"))}
    page = (ROOT / "docs" / "ros2.md").read_text().splitlines()
    (line,) = (line for line in page if line.startswith("pip install 'numba"))
    assert set(shlex.split(line)[2:]) == others | {"numpy>=1.26,<2"}


def _modules(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    return [node.module] if isinstance(node, ast.ImportFrom) and node.module else []
