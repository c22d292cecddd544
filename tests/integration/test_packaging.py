"""The wheel carries everything the source tree has: packages, data, ament markers, node executables."""

from __future__ import annotations

import zipfile

import pytest

from tests.integration.distribution import ROOT, build_wheel, executables

SHARE, DATA = "share/space_robot", "space_robot-0.1.0.data/data"
PACKAGES = [f"space_robot_{name}" for name in ("msgs_py", "description", "control", "sim", "bringup")]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    return zipfile.ZipFile(build_wheel(tmp_path_factory.mktemp("wheel")))


def test_the_wheel_holds_every_module_and_every_config_file(wheel: zipfile.ZipFile) -> None:
    """A file added to the tree is not forgotten in the installation."""
    held = set(wheel.namelist())
    files = (path for name in PACKAGES for path in (ROOT / name).rglob("*") if path.suffix in (".py", ".j2"))
    modules = {path.relative_to(ROOT).as_posix() for path in files}
    config = {
        f"{DATA}/{SHARE}/{path.relative_to(ROOT).as_posix()}" for path in (ROOT / "config").rglob("*") if path.is_file()
    }
    assert config
    assert modules | config <= held, sorted((modules | config) - held)


def test_the_wheel_is_an_ament_package_with_executables(wheel: zipfile.ZipFile) -> None:
    """Every package has its marker, and the node executables are there and may be executed."""
    held = {info.filename: info for info in wheel.infolist()}
    for name in [*PACKAGES, "space_robot"]:
        assert f"{DATA}/share/ament_index/resource_index/packages/{name}" in held
    assert f"{DATA}/{SHARE}/package.xml" in held
    assert {"space_robot_sim/simulator", "space_robot_control/adaptive_controller"} <= set(executables())
    for place in executables():
        info = held[f"{DATA}/lib/{place}"]
        assert info.external_attr >> 16 & 0o111, f"{place} is not executable"
