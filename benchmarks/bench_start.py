"""What it takes to start: CPU time of commands over that of imports which none of them can do without."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

REPEATS = 5
PYTHON = (sys.executable, "-c")
TOOL = (sys.executable, "-m", "space_robot_cli")
NUMPY, MODELS = "import numpy", "import numpy, pydantic"
COMMANDS = ("--version", "list", "robot servicer", "schema", "check giordano2023/sec5")


def run() -> dict[str, float]:
    """Seconds of CPU, and how many times those of the imports; the least of five turns."""
    table: dict[str, float] = {}
    seconds = cpu_seconds(COMMANDS, REPEATS)
    for name in (NUMPY, MODELS):
        table[f'`python -c "{name}"`: s of CPU'] = seconds[name]
    for command in COMMANDS:
        table[f"`{command}`: s of CPU"] = seconds[command]
        table[f"`{command}`: over NumPy and pydantic"] = seconds[command] / seconds[MODELS]
        table[f"`{command}`: over NumPy"] = seconds[command] / seconds[NUMPY]
    return table


def cpu_seconds(commands: Iterable[str], repeats: int) -> Mapping[str, float]:
    """The least CPU time [s] of processes that take turns: the two imports, and commands of the tool.

    Args:
        commands: as they are typed, behind the name of the tool.
        repeats: turns.
    """
    typed = {NUMPY: (*PYTHON, NUMPY), MODELS: (*PYTHON, MODELS)}
    typed |= {command: (*TOOL, *command.split()) for command in commands}
    taken: dict[str, list[float]] = {name: [] for name in typed}
    for _ in range(repeats):
        for name, command in typed.items():
            taken[name].append(_cpu(command))
    return {name: min(times) for name, times in taken.items()}


def _cpu(command: tuple[str, ...]) -> float:
    out = (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)
    child = os.posix_spawn(command[0], command, os.environ, file_actions=[out])
    _, status, used = os.wait4(child, 0)
    if status:
        raise RuntimeError(f"{' '.join(command)} ended with status {status} in {Path.cwd()}")
    return used.ru_utime + used.ru_stime
