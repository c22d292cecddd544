"""What the tool says of itself and of what is shipped."""

from __future__ import annotations

from importlib.metadata import version

import pytest

from space_robot_cli.main import app
from space_robot_cli.panels import OTHERS, PANELS
from space_robot_control.laws import law_class, law_names
from tests.support.tool import Tool

SUMMARY = 60  # characters


def test_every_command_is_in_a_panel_and_said_in_a_line(space_robot: Tool) -> None:
    """What one begins with comes first, and no summary is cut off in a terminal of 80 columns."""
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
