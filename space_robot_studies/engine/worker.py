"""A worker process: does one task after the other, and ends when nothing more can come."""

from __future__ import annotations

import ctypes
import os
import signal
import traceback
from contextlib import suppress
from multiprocessing.connection import Connection

from space_robot_bringup.modes.pinned import PINNED
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_studies.engine.garbage_collection import collect_rarely
from space_robot_studies.engine.tasks import Lost, Task

PR_SET_PDEATHSIG = 1


def settle() -> None:
    """Make this process one that runs unattended.

    Ctrl-C in a terminal, and what stops a service, reach every process of a group: the parent alone decides what
    follows. What a law prints goes to stderr, because stdout belongs to the results of the command.
    """
    os.environ.update(PINNED)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    os.dup2(2, 1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    collect_rarely()


def work(connection: Connection) -> None:
    """Do the tasks that come, until the other end is closed; a dead spawner ends it at once."""
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    while True:
        try:
            answer = attempt(connection.recv())
        except (EOFError, OSError):
            return
        try:
            connection.send(answer)
        except OSError:
            return
        except Exception as error:
            # What cannot be serialised says so in many ways.
            connection.send(Lost(f"bug: the result cannot be sent: {error}"))


def attempt(task: Task[object]) -> object:
    """The result of a task, or what it raised; also what only a caller of ``sys.exit`` means to survive."""
    try:
        return task.function(*task.arguments)
    except SpaceRobotError as error:
        return Lost(f"lost: {type(error).__name__}", str(error), error)
    except BaseException as error:
        return Lost(bug(error), traceback.format_exc())


def bug(error: BaseException) -> str:
    """The reason of a run that raised what no part of it should."""
    said = " ".join(str(error).split())
    return f"bug: {type(error).__name__}: {said}" if said else f"bug: {type(error).__name__}"
