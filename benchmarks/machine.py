"""What a table was measured on."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

LIBRARIES = ("numpy", "numba", "pin", "pydantic", "typer", "mcap", "mujoco", "ros-jazzy-rclpy")


def described() -> str:
    """Processor, cores, vectors, Python, libraries and the load beside the run, in one line."""
    cores = len(os.sched_getaffinity(0))
    libraries = ", ".join(f"{name} {found}" for name in LIBRARIES if (found := _version(name)))
    load = os.getloadavg()[0]
    return (
        f"{_processor()}, {cores} cores, {platform.system()}, CPython {platform.python_version()}, {libraries}; "
        f"{load:.1f} processes wanted to run beside it"
    )


def _processor() -> str:
    """Model and widest vectors; a virtual machine may hide the model."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.machine()
    found = {name.strip(): value.strip() for name, _, value in (line.partition(":") for line in lines)}
    flags = found.get("flags", "").split()
    vectors = next((name for flag, name in (("avx512f", "AVX-512"), ("avx2", "AVX2")) if flag in flags), "")
    return " with ".join(filter(None, (found.get("model name", platform.machine()), vectors)))


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
