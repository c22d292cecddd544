"""To log a line costs no look through all modules that are loaded."""

from __future__ import annotations

import inspect
import sys

import pytest

pytest.importorskip("rclpy")
from rclpy.impl import rcutils_logger

from space_robot_msgs_py.nodes import base, callers


def test_inspect_knows_who_logs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the modules of nodes and of the logger it asks no file system."""
    monkeypatch.setattr(inspect, "modulesbyfile", {})
    callers.note_files()

    def refused(*_: object) -> str:
        raise AssertionError("all modules are looked at")

    monkeypatch.setattr(inspect, "getabsfile", refused)
    for function in (base.GraphNode.refuse, rcutils_logger.RcutilsLogger.log):
        code = function.__code__
        assert inspect.getmodule(code, inspect.getsourcefile(code)) is sys.modules[function.__module__]
