"""What the process that shows a run has to know of it."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from space_robot_msgs_py.topics import TABLE, Topic


@dataclass(frozen=True, slots=True)
class Brief:
    """A run, and where it is shown.

    Attributes:
        title: of the run, as plain text.
        about: a line on it, as plain text.
        joint_names: of the robot, in model order.
        urdf: of the nominal robot, as in the log.
        topics: names of the optional topics of this run.
        tool: the link whose way is drawn; empty: the end of the arm.
        meshes: folders the robot's meshes may be read from, see ``look_of``.
        view: port of the viewer; None: there is none.
        foxglove: port for Foxglove; None: there is none.
    """

    title: str
    about: str
    joint_names: tuple[str, ...]
    urdf: str
    topics: tuple[str, ...] = ()
    tool: str = ""
    meshes: tuple[str, ...] = ()
    view: int | None = None
    foxglove: int | None = None

    @property
    def optional(self) -> frozenset[Topic]:
        """The optional topics of this run."""
        return frozenset(topic for topic in TABLE if topic.name in self.topics)

    @property
    def folders(self) -> tuple[Path, ...]:
        """Of meshes."""
        return tuple(map(Path, self.meshes))

    def line(self) -> str:
        """As one line of text."""
        return json.dumps(asdict(self))

    @classmethod
    def of_line(cls, line: str) -> Brief:
        """Inverse of ``line``."""
        given: dict[str, Any] = json.loads(line)
        given |= {key: tuple(value) for key, value in given.items() if isinstance(value, list)}
        return cls(**given)
