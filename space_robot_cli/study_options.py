"""Options that comparisons and reproductions share."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from space_robot_msgs_py.bounded_files import is_directory, short
from space_robot_msgs_py.errors import InputFileError
from space_robot_studies.engine.tasks import TIME_LIMIT


@dataclass(frozen=True, slots=True)
class StudyOptions:
    """How many runs are executed and shown.

    Attributes:
        workers: processes; None: one per core.
        resume: go on with what is in the directory.
        time_limit: [s] of CPU time of a run; None: the default.
        markdown: where everything goes as tables; None: nowhere.
        as_json: print numbers and nothing else on stdout.
    """

    workers: int | None = None
    resume: bool = False
    time_limit: float | None = None
    markdown: Path | None = None
    as_json: bool = False

    @property
    def seconds(self) -> float:
        """The time limit of a run [s]."""
        return TIME_LIMIT if self.time_limit is None else self.time_limit

    def check_markdown(self) -> None:
        """Refuse a file for tables that could not be written at the end.

        Raises:
            InputFileError: there is no such folder.
        """
        if self.markdown is not None and not is_directory(self.markdown.resolve().parent):
            raise InputFileError("no such folder", key="--markdown", value=short(self.markdown))
