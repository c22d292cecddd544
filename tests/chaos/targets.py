"""What is fuzzed: YAML, URDF, logs and the command line, each case a function of a random generator and a folder."""

from __future__ import annotations

import json
import struct
import sys
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from io import StringIO
from pathlib import Path
from random import Random
from typing import Any
from unittest.mock import patch

from space_robot_bringup.experiment.experiment import experiment_from, experiment_path, load_experiment
from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_bringup.logs import info
from space_robot_bringup.logs.assessed import read_judged
from space_robot_bringup.logs.info import bag_info
from space_robot_bringup.logs.logged import compose_logged
from space_robot_bringup.modes.run import run_experiment
from space_robot_bringup.replay.publish import open_broadcast
from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_cli import main as cli
from space_robot_description.load import load_robot, robot_path
from space_robot_description.share import config_dir
from space_robot_description.validation import parse_yaml_text, parse_yaml_value
from space_robot_description.visual import look_of
from space_robot_msgs_py.log.directory import custom_data
from space_robot_msgs_py.log.mcap.records import MAGIC, flatten, scan
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.recover import recover
from space_robot_msgs_py.transforms import FrameTransforms
from space_robot_studies.campaign.cases import make_case
from space_robot_studies.campaign.spec import load_campaign
from space_robot_studies.reproduce.plan import manifest_path, read_manifest
from tests.chaos.bad_files import Bags, bad_log, bad_yaml, changed_xml
from tests.chaos.nasty import VALUES, changed_text
from tests.support.bombs import BAD_XML

ROBOTS = ("mini", "servicer", "ets7")


class TracebackShown(Exception):
    """A command ended otherwise than with 0, 1 or 2, or showed what is for programmers."""


def make_bags(folder: Path) -> Bags:
    """Run half a second."""
    directory = folder / "run"
    run_experiment(load_experiment("liu2023/fig08", ["duration=1.0", "expect={}"]), directory, mode="headless")
    path = LogReader(directory).path
    with path.open("rb") as stream:
        stream.seek(len(MAGIC))
        records = [*flatten(scan(stream, path.stat().st_size), str(path))]
    plain = MAGIC + b"".join(struct.pack("<BQ", opcode, len(content)) + content for opcode, content in records)
    return Bags(path.read_bytes(), plain, folder)


def yaml_case(random: Random, folder: Path, bags: Bags) -> None:
    """A text that is nearly an experiment, a robot, a campaign, a manifest, a description or an override."""
    kind = random.choice(("experiment", "experiment", "logged", "robot", "campaign", "paper", "metadata", "value"))
    if kind == "value":
        parse_yaml_value(changed_text(random.choice(("[1, {a: 2}]", "0.5", "{x: [a, b]}")), random), "--set x")
        return
    path = _shipped(kind, random)
    text = bad_yaml(path.read_text(encoding="utf-8"), random)
    file = folder / "file.yaml"
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    if kind == "experiment":
        compose_logged(load_experiment(str(file)))
    elif kind == "logged":
        compose_logged(experiment_from(parse_yaml_text(text, "experiment"), "experiment"))
    elif kind == "robot":
        load_robot(file)
    elif kind == "campaign":
        make_case(load_campaign(str(file)), 0).experiment()
    elif kind == "paper":
        read_manifest(file, "paper")
    else:
        file.rename(folder / "metadata.yaml")
        custom_data(folder / "x_0.mcap")


def urdf_case(random: Random, folder: Path, bags: Bags) -> None:
    """A text that is nearly a URDF, in a robot file, in the viewer and in the transforms of a log."""
    robot = dict(_robot(random.choice(ROBOTS)))
    if random.random() < 0.15:
        robot["urdf"] = random.choice(list(BAD_XML.values()))[0]
    elif random.random() < 0.5:
        robot["urdf"] = changed_text(robot["urdf"], random)
    else:
        robot["urdf"] = changed_xml(robot["urdf"], random)
    match random.randrange(4):
        case 0:
            look_of(robot["urdf"])
        case 1:
            FrameTransforms(robot["urdf"], ("joint1", "joint2"))
        case 2:
            (folder / "arm.urdf").write_bytes(robot["urdf"].encode("utf-8", "surrogatepass"))
            file = folder / "robot.yaml"
            file.write_text(dump_yaml(robot | {"urdf": "arm.urdf"}), encoding="utf-8")
            load_robot(file)
        case _:
            load_robot(robot)


def mcap_case(random: Random, folder: Path, bags: Bags) -> None:
    """A file that is nearly a log, through one of the commands' own ways in."""
    path = folder / "bad" / "bad_0.mcap"
    path.parent.mkdir()
    path.write_bytes(bad_log(random, bags))
    if random.random() < 0.3:
        text = dump_yaml({"rosbag2_bagfile_information": {"custom_data": {"mode": random.choice(VALUES)}}})
        path.with_name("metadata.yaml").write_text(changed_text(text, random), "utf-8", "surrogatepass")
    read = random.choice(READERS)
    read(random.choice((path, path.parent)), folder)


def cli_case(random: Random, folder: Path, bags: Bags) -> None:
    """A random command line, over files that are there and others that are not.

    Raises:
        TracebackShown: it did not end with one line and 0, 1 or 2.
    """
    bag = folder / "bag"
    bag.mkdir()
    (bag / "bag_0.mcap").write_bytes(bags.closed if random.random() < 0.7 else bad_log(random, bags))
    (folder / "file.yaml").write_text(
        bad_yaml(experiment_path("liu2023/fig08").read_text(), random), "utf-8", "replace"
    )
    arguments = [random.choice(COMMANDS), *(_argument(random, folder) for _ in range(random.randint(0, 4)))]
    said, complained = StringIO(), StringIO()
    with patch.object(sys, "argv", ["space-robot", *arguments]), redirect_stdout(said), redirect_stderr(complained):
        try:
            cli.main()
        except SystemExit as end:
            code = end.code
    printed = said.getvalue() + complained.getvalue()
    if code not in (0, 1, 2) or "Traceback" in printed or "\x1b" in printed:
        raise TracebackShown(f"{arguments!r} ended with {code!r}: {complained.getvalue()[:500]}")
    if code == 2 and len(complained.getvalue().strip().splitlines()) > 3:
        raise TracebackShown(f"{arguments!r} complained in many lines: {complained.getvalue()[:500]}")


KINDS: dict[str, Callable[[Random, Path, Bags], None]] = {
    "yaml": yaml_case,
    "urdf": urdf_case,
    "mcap": mcap_case,
    "cli": cli_case,
}
# What runs for long or starts processes is only given what it must refuse.
COMMANDS = (
    *("info", "info", "replay", "replay", "recover", "report", "view", "plot"),
    *("check", "schema", "robot", "run", "list", "no such command"),
)
OPTIONS = (
    *("--json", "--out", "-o", "--against", "--set", "--rtol", "--atol", "--ignore", "--experiment", "--namespace"),
    *("--rate", "--loop", "--topics", "--as", "--law", "--allow-code", "--meshes", "--port", "--kind", "--mode"),
    *("--duration", "--realtime", "--from", "--index", "--no-browser", "--help"),
)


def _argument(random: Random, folder: Path) -> str:
    if random.random() < 0.35:
        return random.choice(OPTIONS)
    there = ("bag", "bag/bag_0.mcap", "file.yaml", "no", ".", "/", "..", "/dev/null", "out", "x" * 5000, "y/" * 2500)
    words = ("controller", "plant", "both", "0", "-1", "1e400", "nan", "8080", "paper", "mini", "controller.law=none")
    value = random.choice((*there, *there, *words, str(random.choice(VALUES)).replace("\0", "")))
    if value == "/":
        return value
    return str(folder / value) if value in there and random.random() < 0.7 else value


def _log_page(path: Path, folder: Path) -> None:
    from space_robot_report.pages.log_report import write_log_report

    write_log_report(path, folder / "page.html")


def _picture(path: Path, folder: Path) -> None:
    from space_robot_report.figures.log import draw

    draw(path, folder / "picture.png")


def _view(path: Path, folder: Path) -> None:
    from space_robot_report.viewer.load import load_show
    from space_robot_report.viewer.motion import Motion

    show, _ = load_show(path)
    Motion(show.look.model, show.film).at(0.3)


def _info(path: Path, folder: Path) -> None:
    from space_robot_cli.render.log import info_dict

    json.dumps(info_dict(bag_info(path)), allow_nan=False)


def _info_by_index(path: Path, folder: Path) -> None:
    with patch.object(info, "LARGE", 0):
        _info(path, folder)


def _replay(path: Path, folder: Path) -> None:
    from space_robot_cli.render.replay import as_dict

    json.dumps(as_dict(replay(path, ReplayOptions("both"))), allow_nan=False)


READERS: Sequence[Callable[[Path, Path], Any]] = (
    _info,
    _info,
    _replay,
    _replay,
    _log_page,
    _view,
    _picture,
    lambda path, folder: recover(path, folder / "again"),
    lambda path, folder: recover(path, folder / "again"),
    lambda path, folder: LogReader(path).arrays(),
    lambda path, folder: LogReader(path).unfit(),
    lambda path, folder: LogReader(path).robot_description,
    lambda path, folder: open_broadcast(path),
    lambda path, folder: read_judged(path),
    lambda path, folder: list(LogReader(path).blocks(7)),
    _info_by_index,
)


def _shipped(kind: str, random: Random) -> Path:
    if kind in ("experiment", "logged"):
        found = sorted((config_dir() / "experiments").rglob("*.yaml"))
    elif kind == "metadata":
        found = sorted((Path(__file__).parents[1] / "data" / "golden").glob("*_mini/metadata.yaml"))
    elif kind == "robot":
        found = [robot_path(name) for name in ROBOTS]
    elif kind == "campaign":
        found = sorted((config_dir() / "campaigns").rglob("*.yaml"))
    else:
        found = [manifest_path(name) for name in ("liu2023",)]
    return random.choice(found)


@cache
def _robot(name: str) -> dict[str, Any]:
    return dict(load_robot(name).resolved)
