"""Which file makes which commands: the one that was typed needs no other file, and typer no others to look at."""

from __future__ import annotations

from importlib import import_module

FILES = {
    "run_command": ("run",),
    "study_commands": ("campaign", "compare", "tune", "benchmark", "reproduce"),
    "view_commands": ("report", "view", "plot", "video", "export"),
    "log_commands": ("replay", "info", "events", "recover"),
    "prepare_commands": ("check", "new", "list", "robot", "schema"),
}
# Those that leave nothing behind which is to be closed, and end in less than a second.
QUICK = (*FILES["prepare_commands"], "--version", "--help")


def load_commands(typed: str = "") -> None:
    """Give the application the command that was typed; all of them where there is none of that name."""
    for file in [file for file, names in FILES.items() if typed in names] or FILES:
        import_module(f"space_robot_cli.{file}")
