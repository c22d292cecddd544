"""Who logs: rclpy asks Python for the file of the caller, and Python looks through all modules for it."""

from __future__ import annotations

import inspect
import sys

# Those that call the logger, and those of the logger itself.
CALLERS = ("space_robot", "rclpy")


def note_files() -> None:
    """Tell ``inspect`` the files of the modules that log.

    It then asks the file system of none: the first line that a node logs would take 50 ms of its CPU, in a start and,
    with a refused message, in the middle of a paced run.
    """
    for name, module in list(sys.modules.items()):
        file = getattr(module, "__file__", None) if name.startswith(CALLERS) else None
        if file is not None:
            inspect.modulesbyfile.setdefault(file, name)
