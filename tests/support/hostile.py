"""Bags that are made to do harm: a harmless run, with another header."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_description.validation import parse_yaml_text
from space_robot_msgs_py.log.header import LogHeader
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink

Edit = Callable[[dict[str, Any]], None]

# A law that leaves a mark when it is as much as imported.
EVIL = """
from pathlib import Path
import numpy as np
from space_robot_control.laws import Law

Path({marker!r}).write_text("ran")

class Evil(Law):
    name = "evil"
    def compute(self, state, reference):
        return np.zeros(6 + self.n), {{"nothing": np.zeros(1)}}

def hook(figure):
    Path({marker!r}).write_text("ran")
"""


def write_evil(folder: Path, marker: Path) -> Path:
    """``evil.py`` in a folder."""
    path = folder / "evil.py"
    path.write_text(EVIL.format(marker=str(marker)), encoding="utf-8")
    return path


def with_experiment(bag: Path, target: Path, edit: Edit) -> Path:
    """A copy of a bag whose experiment was edited; everything else, checksums too, is as this project writes it."""
    header = LogReader(bag).header
    data = parse_yaml_text(header.experiment, "experiment")
    edit(data)
    return with_header(bag, target, replace(header, experiment=dump_yaml(data)))


def with_header(bag: Path, target: Path, header: LogHeader, reason: str = "completed") -> Path:
    """A copy of a bag with another header."""
    reader = LogReader(bag)
    sink = LogSink(target, header)
    for tick in reader.ticks():
        sink.record(tick)
    sink.close(reason)
    return target
