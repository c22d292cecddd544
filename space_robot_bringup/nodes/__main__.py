"""What an executable in ``lib/`` starts: ``python -m space_robot_bringup.nodes NAME ARGUMENTS...``."""

import os
import signal
import sys
from types import FrameType


def leave_at_once(number: int, frame: FrameType | None) -> None:
    """Nothing is begun that would have to be ended in order."""
    os._exit(0)


if __name__ == "__main__":
    # Before anything else is imported, which takes a second and more: as a run in progress, a start that is interrupted
    # is no failure.
    for one in (signal.SIGINT, signal.SIGTERM):
        signal.signal(one, leave_at_once)
    from space_robot_bringup.nodes.executables import start

    start(sys.argv[1], sys.argv[2:])
