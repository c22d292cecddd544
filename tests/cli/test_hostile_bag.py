"""A log is data: whatever it names, no command that reads it runs any of it."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_bringup.modes.run import run_experiment
from space_robot_bringup.replay.publish import open_broadcast
from space_robot_cli.app import app
from space_robot_cli.commands import load_commands
from space_robot_description.validation import parse_yaml_text
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.recover import recover
from tests.support.hostile import with_experiment, write_evil
from tests.support.tool import Tool, refused

RUN = ("liu2023/fig08", ("duration=1.0", "expect={}"))


@dataclass
class Trap:
    """A folder with an evil file and a harmless bag, and whether the file was run."""

    folder: Path
    bag: Path
    marker: Path

    @property
    def sprung(self) -> bool:
        return self.marker.exists()


@pytest.fixture(scope="module")
def harmless(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("bags") / "harmless"
    name, overrides = RUN
    run_experiment(load_experiment(name, overrides), directory, mode="headless")
    return directory


@pytest.fixture
def trap(harmless: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Trap]:
    """Evil in the working directory, in the folder of the bag and on the import path."""
    marker = tmp_path / "marker"
    (tmp_path / "bag").mkdir()
    for folder in (tmp_path, tmp_path / "bag"):
        write_evil(folder, marker)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    yield Trap(tmp_path, harmless, marker)
    for name in ("evil", "space_robot_law_evil"):
        sys.modules.pop(name, None)


def law(path: str) -> Callable[[dict[str, Any]], None]:
    def edit(data: dict[str, Any]) -> None:
        data["controller"]["law"], data["controller"]["gains"] = path, {}

    return edit


def standby(data: dict[str, Any]) -> None:
    data["controller"]["standby"] = {"other": {"law": "evil.py:Evil"}, "evil:Evil": {}}
    data["controller"]["switches"] = [{"time": 0.25, "to": "other"}]


def robot(data: dict[str, Any]) -> None:
    data["robot"]["urdf"] = "package://evil/evil.urdf"


def base(data: dict[str, Any]) -> None:
    data["robot"] = "evil.yaml"


NAMED = {
    "a file in the working directory": law("evil.py:Evil"),
    "a file in the folder of the bag": law("bag/evil.py:Evil"),
    "a module on the path": law("evil:Evil"),
    "a module of the standard library": law("antigravity:geohash"),
    "laws in standby": standby,
    "a URDF in a package": robot,
    "a robot file": base,
}
# Every command of the tool is one of these; a new one has to be put here.
READ_LOGS: dict[str, tuple[tuple[str, ...], ...]] = {
    "info": ((), ("--json",)),
    "events": ((), ("--json",)),
    "report": ((),),
    "plot": ((),),
    "video": (("--seconds", "0.4", "--fps", "5"),),
    "export": ((), ("--out", "table.parquet", "--overwrite")),
    "recover": ((),),
    "replay": (
        (),
        ("--against", "controller"),
        ("--against", "plant"),
        ("--against", "both", "--json"),
        ("--update-refs",),
    ),
    # Served until Ctrl-C: see the test of what it loads.
    "view": (),
    # Of the directory of a campaign: see the test of those.
    "run": (),
}
RUN_WHAT_IS_TYPED = {"benchmark", "campaign", "check", "compare", "list", "new", "reproduce", "robot", "schema", "tune"}


def test_every_command_is_known_here() -> None:
    """A command that is new must say whether it reads third-party data."""
    load_commands()
    names = {command.name or command.callback.__name__ for command in app.registered_commands if command.callback}
    assert names == set(READ_LOGS) | RUN_WHAT_IS_TYPED


@pytest.mark.parametrize("named", NAMED)
def test_no_command_runs_what_a_log_names(named: str, trap: Trap, space_robot: Tool) -> None:
    """Every reading command ends without a traceback, and nothing that the log names was imported."""
    pytest.importorskip("plotly")
    with_experiment(trap.bag, trap.folder / "bag" / "run", NAMED[named])
    for command, variants in READ_LOGS.items():
        for options in variants:
            done = space_robot(command, "bag/run", *options)
            assert done.returncode in (0, 1, 2)
            assert "Traceback" not in done.stderr
            assert not trap.sprung, (command, options)


@pytest.mark.parametrize("named", NAMED)
def test_neither_the_viewer_nor_a_replay_on_the_graph_runs_it(named: str, trap: Trap) -> None:
    """What the viewer and the replayer load of such a log runs nothing."""
    pytest.importorskip("viser")
    from space_robot_report.viewer.load import load_show

    bag = with_experiment(trap.bag, trap.folder / "bag" / "run", NAMED[named])
    load_show(bag)
    open_broadcast(bag)
    recover(bag, trap.folder / "again")
    assert not trap.sprung


def test_a_replay_against_the_plant_needs_no_law(trap: Trap, space_robot: Tool) -> None:
    """The plant of a log of an unknown law replays to the bit; against the controller the law has to be typed."""
    with_experiment(trap.bag, trap.folder / "bag" / "run", NAMED["a file in the working directory"])
    assert space_robot("replay", "bag/run", "--against", "plant").returncode == 0
    refused(space_robot("replay", "bag/run"), "controller.law", "'evil.py:Evil'", "--law", "--allow-code")
    assert not trap.sprung


@pytest.mark.parametrize(
    "typed",
    [("--law", "evil.py:Evil"), ("--allow-code",), ("--set", "controller.law=evil.py:Evil")],
    ids=["law", "allow-code", "set"],
)
def test_a_law_named_by_the_user_is_imported(typed: tuple[str, ...], trap: Trap, space_robot: Tool) -> None:
    """A law that the user typed, or all code the user vouches for, is imported and compared."""
    with_experiment(trap.bag, trap.folder / "bag" / "run", law("evil.py:Evil"))
    done = space_robot("replay", "bag/run", "--against", "controller", *typed)
    assert done.returncode == 1
    assert trap.sprung
    assert "the log does not say which code the law evil.py:Evil had" in done.stdout


def test_a_law_in_the_place_of_one_of_several_needs_its_name(trap: Trap, space_robot: Tool) -> None:
    """With two laws of unknown code ``--law`` says which one it is for."""
    with_experiment(trap.bag, trap.folder / "bag" / "run", standby)
    refused(space_robot("replay", "bag/run", "--law", "evil.py:Evil"), "--law", "NAME=evil.py:Evil", "other")
    refused(space_robot("replay", "bag/run", "--law", "no=evil.py:Evil"), "--law", "'no'", "other")
    assert not trap.sprung


def campaign_of(trap: Trap, edit: Callable[[dict[str, Any]], None]) -> Path:
    data = parse_yaml_text(LogReader(trap.bag).header.experiment, "experiment")
    edit(data)
    folder = trap.folder / "campaign"
    folder.mkdir()
    (folder / "resolved.yaml").write_text(dump_yaml({"title": "sent", "experiment": data, "runs": 2}))
    return folder


@pytest.mark.parametrize("named", NAMED)
@pytest.mark.parametrize("mode", ["headless", "processes"])
def test_the_directory_of_a_campaign_brings_no_code(named: str, mode: str, trap: Trap, space_robot: Tool) -> None:
    """``run --from`` refuses what a campaign that was sent names, whatever the mode; nothing ran, nothing is left."""
    campaign_of(trap, NAMED[named])
    done = space_robot("run", "--from", "campaign", "--index", "0", "--mode", mode, "--out", "out")
    refused(done)
    assert not trap.sprung
    assert not (trap.folder / "out").exists()
    space_robot("report", "campaign")
    assert not trap.sprung


def test_run_from_a_campaign_uses_the_law_of_the_option(trap: Trap, space_robot: Tool) -> None:
    """``run --from --law`` runs that law, and the log names it; without ``--from`` the option is refused."""
    campaign_of(trap, law("their.py:Law"))
    space_robot(
        "run", "--from", "campaign", "--index", "0", "--mode", "headless", "--law", "evil.py:Evil", "--out", "o"
    )
    assert trap.sprung
    assert "law: evil.py:Evil" in LogReader(trap.folder / "o").header.experiment
    refused(space_robot("run", "liu2023/fig08", "--law", "evil.py:Evil"), "--law", "--from")


def test_the_log_carries_the_source_of_a_custom_law(trap: Trap, space_robot: Tool) -> None:
    """A custom law is in its log as text with a digest, a shipped one is not; another file is named by a replay."""
    name, overrides = RUN
    options = [part for one in overrides for part in ("--set", one)]
    options += ["--set", "controller.law=evil.py:Evil", "--set", "controller.gains={}"]
    space_robot("run", name, *options, "--out", "custom")
    header = LogReader(trap.folder / "custom").header
    source = (trap.folder / "evil.py").read_bytes()
    (kept,) = header.laws.values()
    assert (kept.class_name, kept.digest, kept.text) == ("Evil", sha256(source).hexdigest(), source.decode())
    assert LogReader(trap.bag).header.laws == {}
    same = space_robot("replay", "custom", "--law", "evil.py:Evil")
    assert same.returncode == 0
    assert "note" not in same.stdout
    (trap.folder / "evil.py").write_bytes(source + b"\n# another file\n")
    other = space_robot("replay", "custom", "--law", "evil.py:Evil")
    assert "the law evil.py:Evil is other code than in the log" in other.stdout


def test_tools_of_others_read_the_attached_source(trap: Trap, space_robot: Tool) -> None:
    """The mcap library lists the source beside experiment and URDF."""
    from mcap.reader import make_reader

    name, overrides = RUN
    options = [
        part for one in (*overrides, "controller.law=evil:Evil", "controller.gains={}") for part in ("--set", one)
    ]
    space_robot("run", name, *options, "--out", "custom")
    with LogReader(trap.folder / "custom").path.open("rb") as stream:
        found = {one.name: one.data.decode() for one in make_reader(stream).iter_attachments()}
    assert list(found) == ["experiment.yaml", "robot.urdf", "law_0.py"]
    assert found["law_0.py"] == (trap.folder / "evil.py").read_text()


def test_files_of_other_tools_in_the_folder_run_nothing(trap: Trap) -> None:
    """Settings of matplotlib and numba that lie in the working directory neither run nor redirect anything."""
    pytest.importorskip("matplotlib")
    (trap.folder / "matplotlibrc").write_text("figure.hooks: evil:hook\ntext.usetex: True\n")
    (trap.folder / ".numba_config.yaml").write_text(f"cache_dir: {trap.folder / 'kernels'}\n")
    for command in (["plot", str(trap.bag), "--out", "picture.png"], ["replay", str(trap.bag)]):
        done = subprocess.run([sys.executable, "-m", "space_robot_cli", *command], check=False, capture_output=True)
        assert done.returncode == 0, done.stderr
    assert not trap.sprung
    assert not (trap.folder / "kernels").exists()
