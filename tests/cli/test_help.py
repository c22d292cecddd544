"""What the tool says of itself and of what is shipped."""

from __future__ import annotations

import json
from importlib.metadata import version

import pytest

from space_robot_cli.app import app
from space_robot_cli.commands import FILES, load_commands
from space_robot_cli.panels import OTHERS, PANELS
from space_robot_control.laws import law_class, law_names
from tests.support.tool import Tool

SUMMARY = 60  # characters


def test_every_command_is_in_a_panel_and_said_in_a_line(space_robot: Tool) -> None:
    """What one begins with comes first, and no summary is cut off in a terminal of 80 columns."""
    load_commands()
    said = space_robot("--help").stdout
    names = {command.name or command.callback.__name__ for command in app.registered_commands if command.callback}
    assert names <= {name for members in PANELS.values() for name in members}
    assert OTHERS not in said
    lines = [line for line in said.splitlines() if line.startswith("  ") and line.split()[0] in names]
    assert len(lines) == len(names)
    assert lines[0].split()[0] == "run"
    for line in lines:
        summary = line.split(maxsplit=1)[1].strip()
        assert len(summary) <= SUMMARY
        assert summary.endswith(".")
        assert not summary.endswith("...")


def test_a_command_is_made_by_the_file_it_stands_in() -> None:
    """That file alone is loaded for it."""
    load_commands()
    made: dict[str, set[str]] = {}
    for command in app.registered_commands:
        assert command.callback is not None
        file = command.callback.__module__.removeprefix("space_robot_cli.")
        made.setdefault(file, set()).add(command.name or command.callback.__name__)
    assert made == {file: set(names) for file, names in FILES.items()}


def test_the_tool_says_its_version(space_robot: Tool) -> None:
    """That of the installation, and nothing else."""
    done = space_robot("--version")
    assert (done.returncode, done.stdout) == (0, f"space-robot {version('space-robot')}\n")


def test_without_a_command_the_help_is_shown(space_robot: Tool) -> None:
    """As it is, not as an error message."""
    done = space_robot()
    assert done.returncode == 2
    assert done.stderr.startswith("Usage: space-robot")
    assert "see --help" not in done.stderr


def test_laws_are_listed_with_their_gains(space_robot: Tool) -> None:
    """Each with what it is, and every gain by the key that `--set` takes."""
    lines = space_robot("list", "laws").stdout.splitlines()
    heads = [line.split()[0] for line in lines if not line.startswith(" ")]
    assert heads == list(law_names())
    gains = {line.split()[0] for line in lines if line.startswith("    ")}
    wanted = {info.alias or name for law in law_names() for name, info in law_class(law).Gains.model_fields.items()}
    assert wanted <= gains


@pytest.mark.parametrize(
    ("kind", "beginning"),
    [("experiments", "liu2023"), ("robots", "m"), ("laws", "ntsmc"), ("faults", "joint_st"), ("campaigns", "fig08")],
)
def test_a_list_can_be_narrowed(space_robot: Tool, kind: str, beginning: str) -> None:
    """To the names that begin so; what does not is not there."""
    whole, part = (space_robot("list", kind, *name).stdout.splitlines() for name in ((), (beginning,)))
    assert len(part) < len(whole)
    assert any(line.split()[0].startswith(beginning) for line in part if line.strip())
    assert set(part) <= set(whole)


def test_a_beginning_of_nothing_is_said(space_robot: Tool) -> None:
    """With what there is that looks like it."""
    done = space_robot("list", "robots", "servicr")
    assert done.returncode == 2
    assert "NAME: none begins so; got 'servicr'; accepted: servicer" in done.stderr


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("run liu2023/fig0", ["liu2023/fig08", "liu2023/fig09"]),
        ("run --mode ", ["headless", "graph", "processes"]),
        ("list la", ["laws"]),
        ("campaign fig08_dispersed --keep a", ["all"]),
        ("replay x --against p", ["plant"]),
        ("reproduce li", ["liu2023"]),
        ("robot mi", ["mini"]),
        ("new ", ["experiment", "law", "robot", "study"]),
    ],
)
def test_a_shell_completes_names_and_choices(
    space_robot: Tool, monkeypatch: pytest.MonkeyPatch, typed: str, offered: list[str]
) -> None:
    """What is shipped, and what an option accepts."""
    monkeypatch.setenv("_SPACE_ROBOT_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", f"space-robot {typed}")
    monkeypatch.setenv("COMP_CWORD", str(len(typed.split()) + typed.endswith(" ")))
    assert space_robot().stdout.split() == offered


def test_what_completion_offers_is_what_is_accepted() -> None:
    """The choices of the shell are those of the library."""
    from space_robot_bringup.logs.happened import SEVERITIES, SOURCES
    from space_robot_cli.catalogue import EXPLAINED, catalogue
    from space_robot_cli.kinds import FOLDERS
    from space_robot_cli.new import KINDS as STARTED
    from space_robot_cli.prepare_commands import FILES as CHECKED
    from space_robot_cli.prepare_commands import LISTED, STARTS

    assert {"list": set(LISTED), "files": set(CHECKED), "new": set(STARTS)} == {
        "list": {*catalogue(), *EXPLAINED},
        "files": set(FOLDERS),
        "new": set(STARTED),
    }
    assert (set(SEVERITIES), set(SOURCES)) == (
        {"info", "low", "medium", "high"},
        {"fault", "plant", "supervisor", "controller"},
    )


def test_the_time_of_the_run_and_the_whole_time_stand_apart(space_robot: Tool) -> None:
    """Set-up and verdict are in the whole time only; both are printed, and in the JSON."""
    found = json.loads(space_robot("run", "liu2023/fig08", "--duration", "1", "--json").stdout)
    assert found["whole_time"] > found["wall_time"] > 0.0
    said = space_robot("run", "liu2023/fig08", "--duration", "1").stdout
    assert "first tick to last" in said
    assert "with set-up, log and verdict" in said
