"""The project as others get it: built from the files under version control, installed elsewhere."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.support.paths import ROOT

UV = Path(sys.executable).with_name("uv")
# What this environment would hand down: the ROS wheels' own bootstrap mark, paths to packages and libraries.
INHERITED = (
    "_ROS_WHEELS_BOOTSTRAP_COMPLETE", "LD_LIBRARY_PATH", "PYTHONPATH", "PYTHONHOME", "AMENT_PREFIX_PATH", "VIRTUAL_ENV",
)  # fmt: skip
UNREACHABLE = ("error sending request", "Failed to fetch", "dns error", "Could not connect", "Connection refused")


def copy_source(folder: Path) -> Path:
    """The files under version control, as they are now, in a folder of their own."""
    tracked = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in filter(None, tracked.split("\0")):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes((ROOT / name).read_bytes())
            (folder / name).chmod((ROOT / name).stat().st_mode)
    return folder


def build_wheel(folder: Path) -> Path:
    """The wheel of the current files, built in this folder from their source distribution."""
    source = copy_source(folder / "source")
    build = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder), str(source)]
    done = subprocess.run(build, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    (wheel,) = folder.glob("*.whl")
    return wheel


def make_venv(folder: Path, requirements: Sequence[str]) -> Path:
    """A fresh environment with these requirements; skips the test where no package index can be reached."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    install = [str(UV), "pip", "install", "-q", "--python", str(folder / "bin" / "python"), *requirements]
    done = subprocess.run(install, capture_output=True, text=True, check=False, env=foreign_environment())
    if done.returncode != 0 and any(words in done.stderr for words in UNREACHABLE):
        pytest.skip(f"the package index cannot be reached: {done.stderr.strip().splitlines()[-1]}")
    assert done.returncode == 0, done.stderr[-2000:]
    return folder


def foreign_environment(**variables: str) -> dict[str, str]:
    """The environment for processes of another installation: nothing of this one is handed down."""
    return {name: value for name, value in os.environ.items() if name not in INHERITED} | variables


def executables() -> list[str]:
    """``package/name`` of every node executable of the source tree."""
    return sorted(path.relative_to(ROOT / "lib").as_posix() for path in (ROOT / "lib").glob("*/*"))
