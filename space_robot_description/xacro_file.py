"""Xacro files to URDF, by the program of that name in a process of its own: such a file is a program, too."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from space_robot_msgs_py.bounded_files import read_bytes, short
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.extras import install
from space_robot_msgs_py.limits import URDF_BYTES

SECONDS = 60.0
# `python -m xacro` does not exist; its own script need not be on PATH.
_PROGRAM = "import sys, xacro; sys.argv[0] = 'xacro'; xacro.main()"


def is_xacro(name: str) -> bool:
    """Whether a file of this name is expanded."""
    return name.endswith(".xacro")


def expand_xacro(path: Path, arguments: Mapping[str, bool | int | float | str]) -> bytes:
    """The URDF that xacro makes of a file.

    Args:
        path: of the file.
        arguments: for its ``<xacro:arg>``.

    Returns:
        UTF-8.

    Raises:
        SpecError: xacro is not installed, refuses the file, or takes more than a minute; or an argument has no name.
        InputFileError: the result is too large.
    """
    where = f"urdf {short(path)}"
    if importlib.util.find_spec("xacro") is None:
        accepted = f"{install('xacro')}, or the URDF that `xacro {path.name} -o FILE.urdf` makes"
        raise SpecError("xacro is not installed", key=where, accepted=accepted)
    with tempfile.TemporaryDirectory() as folder:
        # To a file, of which no more is read than a URDF may have.
        out = Path(folder) / "robot.urdf"
        command = [sys.executable, "-c", _PROGRAM, str(path.resolve()), "-o", str(out), *_mappings(arguments)]
        try:
            done = subprocess.run(command, capture_output=True, timeout=SECONDS, check=False, stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            accepted = f"a file that is expanded within {SECONDS:g} s"
            raise SpecError("xacro takes too long", key=where, accepted=accepted) from None
        if done.returncode != 0:
            said = " ".join(done.stderr.decode("utf-8", "replace").split())
            raise SpecError(f"xacro refuses the file: {said or 'it says nothing'}", key=where)
        return read_bytes(out, URDF_BYTES, where)


def _mappings(arguments: Mapping[str, bool | int | float | str]) -> list[str]:
    for name in arguments:
        if not name.isidentifier():
            raise SpecError(
                "no name of a xacro argument", key="xacro_args", value=name, accepted="letters, digits and _"
            )
    return [f"{name}:={value}" for name, value in arguments.items()]
