"""Where shipped data and other packages' data are found; the one place that reads the environment."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import unquote

from space_robot_description.yaml_files import nearest
from space_robot_msgs_py.bounded_files import is_file as is_file
from space_robot_msgs_py.bounded_files import short
from space_robot_msgs_py.errors import InputFileError
from space_robot_msgs_py.extras import install
from space_robot_msgs_py.paths import StrPath

DATA = Path("share") / "space_robot" / "config"
WHEEL_SCHEME = "example-robot-data:"


def config_dir() -> Path:
    """The folder of shipped robots, experiments, campaigns and faults.

    In a source tree that is its ``config/``; installed, it is ``share/space_robot/config`` of the Python prefix or of
    an entry of AMENT_PREFIX_PATH, the first that exists.

    Raises:
        InputFileError: none of them exists.
    """
    source = Path(__file__).resolve().parent.parent / "config"
    candidates = [source, *(prefix / DATA for prefix in [Path(sys.prefix), *_ament_prefixes()])]
    for candidate in candidates:
        if (candidate / "robots").is_dir():
            return candidate
    raise InputFileError("the shipped config folder was not found", accepted=", ".join(str(c) for c in candidates))


def shipped(kind: str) -> list[str]:
    """Sorted names of the shipped files of a kind, e.g. ``shipped("robots")``, folders with ``/``, without suffix."""
    root = config_dir() / kind
    return sorted(path.relative_to(root).with_suffix("").as_posix() for path in root.rglob("*.yaml"))


def shipped_or_file(name_or_path: StrPath, kind: str, *, key: str, message: str) -> Path:
    """The file of what is shipped under this name, or the given path.

    Args:
        name_or_path: a path that is a file wins.
        kind: folder of ``config_dir()``.
        key: what one of the kind is called, for errors.
        message: what is wrong where there is neither.

    Raises:
        InputFileError: there is neither; with the nearest shipped names.
    """
    said = os.fspath(name_or_path)
    if is_file(path := Path(said)):
        return path
    if is_file(inside := config_dir() / kind / f"{said}.yaml"):
        return inside
    names = shipped(kind)
    known = nearest(said, names) or ", ".join(names)
    accepted = f"a YAML file, or one of: {known}" if known else f"a YAML file (no {key} is shipped)"
    raise InputFileError(message, key=key, value=short(said), accepted=accepted)


def resource(uri: str, folder: Path) -> Path:
    """The file a robot file points at.

    Args:
        uri: a path relative to ``folder``, an absolute path, ``package://<package>/<path>`` in the share folder of a
            package on AMENT_PREFIX_PATH, or ``example-robot-data:<path under robots/>`` of the wheel of that name.
        folder: where relative paths start.

    Raises:
        InputFileError: there is no such file; the message says what would bring it.
    """
    if uri.startswith(WHEEL_SCHEME):
        return _in_wheel(uri)
    if uri.startswith("package://"):
        return _in_package(uri)
    path = folder / uri
    if not is_file(path):
        accepted = "a file beside the robot file"
        raise InputFileError("no such URDF file", key="urdf", value=short(path), accepted=accepted)
    return path


def mesh_file(uri: str, folders: Sequence[Path] = ()) -> Path | None:
    """The file of a mesh in a composed URDF, where it may be read.

    A URDF may come out of a third-party log: it names no file but those of the shipped robots, of ROS packages,
    of wheels and of folders that the user typed.

    Args:
        uri: ``file://`` or a path, or ``package://`` in a ROS package or a wheel.
        folders: that the user typed.
    """
    shares = [prefix / "share" for prefix in [*_ament_prefixes(), *_wheel_prefixes()]]
    if uri.startswith("package://"):
        candidates = [share / uri.removeprefix("package://") for share in shares]
    else:
        candidates = [Path(unquote(uri.removeprefix("file://")))]
    # By name, not by where links lead: installed files may be links, and nothing else makes any in these folders.
    allowed = [os.path.abspath(place) for place in (*shares, config_dir(), *folders)]
    for path in candidates:
        place = os.path.abspath(path)
        if any(place.startswith(f"{folder}{os.sep}") for folder in allowed) and is_file(path):
            return Path(place)
    return None


def mesh_folders(urdf: str) -> list[Path]:
    """Where the meshes of a robot lie of the user's own run: those may be drawn."""
    found = dict.fromkeys(re.findall(r'filename="file://([^"]+)"', urdf))
    return list(dict.fromkeys(Path(unquote(path)).parent for path in found))


def _wheel_prefixes() -> list[Path]:
    """Where cmeel wheels unpack: beside the ordinary packages, so every import root is a candidate."""
    return [prefix for entry in sys.path if (prefix := Path(entry) / "cmeel.prefix").is_dir()]


def wheel_urdfs() -> list[str]:
    """Sorted paths of the URDFs of the example-robot-data wheel, below its ``robots/``.

    Raises:
        InputFileError: it is not installed.
    """
    root = _wheel_robots(WHEEL_SCHEME)
    return sorted(path.relative_to(root).as_posix() for path in root.rglob("*.urdf"))


def _in_wheel(uri: str) -> Path:
    path = _wheel_robots(uri) / uri.removeprefix(WHEEL_SCHEME)
    if not is_file(path):
        raise InputFileError("the example-robot-data wheel has no such file", key="urdf", value=uri)
    return path


def _wheel_robots(uri: str) -> Path:
    inside = Path("share") / "example-robot-data" / "robots"
    roots = [root for prefix in _wheel_prefixes() if (root := prefix / inside).is_dir()]
    if not roots:
        raise InputFileError(
            "the robots of the example-robot-data wheel are not installed",
            key="urdf",
            value=uri,
            accepted=install("robots"),
        )
    return roots[0]


def _in_package(uri: str) -> Path:
    relative = uri.removeprefix("package://")
    for prefix in _ament_prefixes():
        if is_file(path := prefix / "share" / relative):
            return path
    raise InputFileError(
        "no such file in the share folder of a ROS package",
        key="urdf",
        value=uri,
        accepted="a package on AMENT_PREFIX_PATH (source its setup file first)",
    )


def _ament_prefixes() -> list[Path]:
    return [Path(entry) for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if entry]
