"""`space_robot.replay`: a recorded run computed again and compared with its log."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from space_robot_bringup.experiment.experiment import Overrides
from space_robot_bringup.logs.foreign_bag import Source
from space_robot_bringup.public.calls import for_python
from space_robot_bringup.public.result import Run
from space_robot_bringup.replay import replay as command
from space_robot_bringup.replay.comparison import Tolerance
from space_robot_bringup.replay.recording import Code
from space_robot_bringup.replay.replay import Replayed, ReplayOptions
from space_robot_msgs_py.paths import StrPath


@for_python
def replay(
    log: StrPath,
    overrides: Overrides | None = None,
    *,
    against: Literal["controller", "plant", "supervisor", "both"] = "both",
    rtol: float = 0.0,
    atol: float = 0.0,
    ignore: Sequence[str] = (),
    experiment: StrPath | None = None,
    namespace: str = "",
    start: Literal["run", "first"] = "run",
    law: str | Sequence[str] = (),
    allow_code: bool = False,
) -> Replayed:
    """Compute a recorded run again, from its log alone, and compare every number.

    Args:
        log: a run, run directory or .mcap file; or a bag of another tool, with ``experiment``.
        overrides: of the recorded experiment, see ``run``.
        against: ``controller`` (recorded states in, commands out), ``plant`` (commands in, states out), ``supervisor``
            (states, commands and orders in, modes and events out) or ``both``: all of them that the run has.
        rtol: what counts as equal, relative to the largest number of a block [-]; with both zero the bits are compared.
        atol: likewise, absolute, in the unit of the field.
        ignore: topics, or topic/block, that are not compared.
        experiment: name or file of what was run, for a bag without one.
        namespace: of the topics in a bag of another tool.
        start: what stamps in such a bag count from: ``run``, or ``first``, its first state, for stamps since 1970.
        law: ``FILE:Class`` or ``NAME=FILE:Class`` in place of a law that is not installed; a log brings no code.
        allow_code: everything the log names may be imported. It always may for a ``Run``, which this process made.

    Returns:
        What is different: ``equal``, and ``outcomes`` side by side.

    Raises:
        SpaceRobotError: the log or an argument cannot be used.
    """
    code = Code(_texts(law), allow_code or isinstance(log, Run))
    options = ReplayOptions(
        against, Tolerance(rtol, atol, _texts(ignore)), overrides or (), experiment, Source(namespace, start), code
    )
    return command.replay(Path(log), options)


def _texts(value: str | Sequence[str]) -> tuple[str, ...]:
    """One text is meant as one, not as its letters."""
    return (value,) if isinstance(value, str) else tuple(value)
