"""The command line: it parses, calls the library and prints; nothing else."""

from __future__ import annotations

import atexit
import gc
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Never

import typer

from space_robot_bringup.modes.signals import Interrupted, raising
from space_robot_cli.app import BAD_INPUT, FAILED, app, err
from space_robot_cli.commands import QUICK, load_commands
from space_robot_cli.system_libraries import missing_library
from space_robot_msgs_py.bounded_files import short
from space_robot_msgs_py.errors import SpaceRobotError

# What typer makes of a KeyboardInterrupt.
INTERRUPTED = 130
# Modules and files that were read stay: to look through them for garbage every 700 objects takes a tenth of a start.
NEW_OBJECTS = 50_000


def main() -> Never:
    """Entry point: one line per error, exit 2 on bad input, 1 on a signal, no traceback."""
    typed = sys.argv[1] if len(sys.argv) > 1 else ""
    try:
        with raising(signal.SIGINT, signal.SIGTERM), _few_collections(typed):
            # Else pydantic asks every installed distribution for plugins, which are code that would see what files say.
            os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "1")
            load_commands(typed)
            # Without standalone mode an Exit of a command is what app returns.
            code = app(prog_name="space-robot", standalone_mode=False)
    except SpaceRobotError as error:
        err.print(f"space-robot: {error}", style="red", markup=False, soft_wrap=True)
        sys.exit(BAD_INPUT)
    except (Interrupted, KeyboardInterrupt, typer.Abort) as error:
        err.print(f"space-robot: {error.reason if isinstance(error, Interrupted) else 'interrupted'}", markup=False)
        sys.exit(FAILED)
    except BrokenPipeError:
        # The reader of stdout is gone, as after `| head`; nothing more can be printed, at the exit neither.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(FAILED)
    except ImportError as error:
        if (said := missing_library(error)) is None:
            raise
        err.print(f"space-robot: {said}", style="red", markup=False, soft_wrap=True)
        sys.exit(BAD_INPUT)
    except OSError as error:
        # What the system refuses of a path that was typed: too long a name, no permission.
        place = f"{short(str(error.filename))}: " if error.filename is not None else ""
        err.print(f"space-robot: {place}{error.strerror or error}", style="red", markup=False, soft_wrap=True)
        sys.exit(BAD_INPUT)
    except Exception as error:
        # Usage errors of the parser know how to show themselves; anything else is a bug and shows its trace.
        show = getattr(error, "format_message", None)
        if show is None:
            raise
        if type(error).__name__ == "NoArgsIsHelpError":
            err.print(show(), markup=False)
            sys.exit(BAD_INPUT)
        err.print(f"space-robot: {show()}; see --help", style="red", markup=False, soft_wrap=True)
        sys.exit(BAD_INPUT)
    if code == INTERRUPTED:
        err.print("space-robot: interrupted", style="red", markup=False)
        sys.exit(FAILED)
    sys.exit(code or 0)


@contextmanager
def _few_collections(typed: str) -> Iterator[None]:
    if typed in QUICK:
        # Python searches all that is left once more before it ends, but not what is frozen.
        atexit.register(gc.freeze)
    before = gc.get_threshold()
    gc.set_threshold(NEW_OBJECTS, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)
