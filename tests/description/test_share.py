"""Shipped data, wheel data and ROS packages are found, and what is missing says what would bring it."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from space_robot_description import share
from space_robot_description.load import load_robot
from space_robot_msgs_py.errors import InputFileError
from tests.support.description_texts import TWO_LINKS, robot_file, urdf
from tests.support.paths import ROOT


def test_source_tree_config_is_found() -> None:
    """In a source tree the shipped files are those of its config folder."""
    assert share.config_dir() == ROOT / "config"
    assert {"mini", "servicer", "ets7", "ur5_sat", "panda_sat"} <= set(share.shipped("robots"))


@pytest.mark.parametrize("where", ["python", "ament"])
def test_installed_config_is_found(where: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Outside a source tree the config of the Python prefix or of an ament prefix is used."""
    config = tmp_path / "share" / "space_robot" / "config"
    (config / "robots").mkdir(parents=True)
    monkeypatch.setattr(share, "__file__", str(tmp_path / "lib" / "space_robot_description" / "share.py"))
    monkeypatch.setattr(sys, "prefix", str(tmp_path if where == "python" else tmp_path / "other"))
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"/nowhere:{tmp_path}" if where == "ament" else "")
    assert share.config_dir() == config


def test_missing_config_says_where_it_looked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without any config folder the error lists the places."""
    monkeypatch.setattr(share, "__file__", str(tmp_path / "lib" / "space_robot_description" / "share.py"))
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    monkeypatch.setenv("AMENT_PREFIX_PATH", "")
    with pytest.raises(InputFileError, match="share/space_robot/config"):
        share.config_dir()


def test_missing_wheel_names_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the wheel the error says which pip package brings it."""
    monkeypatch.setattr(sys, "path", ["/nowhere"])
    with pytest.raises(InputFileError, match=r"install space-robot\[robots\]: pip install "):
        load_robot("ur5_sat")


def test_ros_package_is_resolved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A package:// URDF is found in the share folder of an ament prefix, and its absence is explained."""
    folder = tmp_path / "share" / "my_arm"
    folder.mkdir(parents=True)
    (folder / "arm.urdf").write_text(urdf(*TWO_LINKS))
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    assert load_robot(robot_file("package://my_arm/arm.urdf")).n == 2
    with pytest.raises(InputFileError, match="AMENT_PREFIX_PATH"):
        load_robot(robot_file("package://my_arm/other.urdf"))
