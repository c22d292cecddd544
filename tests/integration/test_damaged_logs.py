"""Whatever happens to the bytes of a log, replay and info work on what is left or say in one line what is wrong."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from space_robot_bringup.logs.info import bag_info
from space_robot_cli.render.log import info_dict
from space_robot_cli.render.replay import as_dict
from space_robot_msgs_py.codec.codecs import LOGGED
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.recover import recover
from space_robot_msgs_py.log.writer import LogWriter
from tests.support.replays import record_run, replayed
from tests.support.tool import Tool


@pytest.fixture(scope="module")
def forms(tmp_path_factory: pytest.TempPathFactory) -> tuple[bytes, bytes]:
    """A short log as it is while it is written, and closed."""
    place = tmp_path_factory.mktemp("logs")
    reader = LogReader(record_run(place / "run", "compare/mini", "duration=2.0", "controller.law=pd"))
    writer = LogWriter(place / "again", reader.header)
    writer.write_description(reader.header.urdf)
    for stamp, parts in reader.stamps():
        writer.write_tick(stamp, {topic: parts[topic.name] for topic in LOGGED if topic.name in parts})
    plain = writer.path.read_bytes()
    writer.close("completed")
    return plain, writer.path.read_bytes()


def replay_it(path: Path) -> None:
    as_dict(replayed(path))


def look_at_it(path: Path) -> None:
    info_dict(bag_info(path))


def spoiled(forms: tuple[bytes, bytes], how: str, index: int, rng: np.random.Generator) -> bytes:
    """One of the forms, cut or with one byte changed."""
    data = bytearray(forms[index % 2])
    place = int(rng.integers(len(data)))
    if how == "cut":
        del data[place:]
    else:
        data[place] ^= int(rng.integers(1, 256))
    return bytes(data)


@pytest.mark.parametrize("attempts", [40, pytest.param(200, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("how", ["cut", "flipped"])
@pytest.mark.parametrize("use", [replay_it, look_at_it])
def test_no_damage_makes_a_traceback(
    forms: tuple[bytes, bytes], tmp_path: Path, use: Callable[[Path], None], how: str, attempts: int
) -> None:
    """At each of many random places: a result or one line, never another exception."""
    rng = np.random.default_rng(66)
    path, worked = tmp_path / "bad_0.mcap", 0
    for index in range(attempts):
        path.write_bytes(spoiled(forms, how, index, rng))
        said = ""
        try:
            use(path)
            worked += 1
        except SpaceRobotError as error:
            said = str(error)
        assert "\n" not in said
    assert worked


@pytest.mark.parametrize("attempts", [10, pytest.param(40, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("use", [replay_it, look_at_it])
def test_memory_is_bounded_by_the_file(
    forms: tuple[bytes, bytes], tmp_path: Path, use: Callable[[Path], None], attempts: int
) -> None:
    """Damaged lengths ask for no memory: a log takes a small multiple of the file, whatever has been loaded for it."""
    rng = np.random.default_rng(67)
    path = tmp_path / "bad_0.mcap"
    for index in range(attempts):
        path.write_bytes(spoiled(forms, "flipped", index, rng))
        # The first use loads the code that this damage needs, which is no memory of the log.
        with suppress(SpaceRobotError):
            use(path)
        tracemalloc.start()
        with suppress(SpaceRobotError):
            use(path)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 20 * len(forms[0])


def test_the_tool_recovers_and_says_what_is_lost(space_robot: Tool, forms: tuple[bytes, bytes], tmp_path: Path) -> None:
    """A cut log is recovered beside the old one, the lines say how far it goes, and the new one replays."""
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad" / "bad_0.mcap").write_bytes(forms[0][:-3000])
    done = space_robot("recover", "bad")
    assert done.returncode == 0, done.stderr
    for words in ("cut within a record", "recovered: ", "last good stamp", "bad_recovered", "the end is not in it"):
        assert words in done.stdout
    assert space_robot("replay", "bad_recovered").returncode == 0
    said = space_robot("info", "bad_recovered").stdout
    assert "ended: the log was truncated" in said
    assert "recovered_from: bad" in said
    again = space_robot("recover", "bad", "-o", "elsewhere", "--json")
    assert again.returncode == 0
    assert (tmp_path / "elsewhere" / "elsewhere_0.mcap").is_file()


def test_recover_refuses_what_cannot_be_recovered(space_robot: Tool, tmp_path: Path) -> None:
    """Exit 2 and one line, and nothing that could be taken for a bag."""
    (tmp_path / "zero_0.mcap").write_bytes(bytes(10_000))
    for command in ("recover", "info", "replay"):
        done = space_robot(command, "zero_0.mcap")
        assert done.returncode == 2
        assert len(done.stderr.strip().splitlines()) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["zero_0.mcap"]


def test_a_recovered_log_replays_as_far_as_it_goes(forms: tuple[bytes, bytes], tmp_path: Path) -> None:
    """What is recovered of a cut is the beginning of the run: equal on both sides."""
    path = tmp_path / "bad_0.mcap"
    path.write_bytes(forms[0][: 3 * len(forms[0]) // 4])
    done = replayed(recover(path, tmp_path / "good").path)
    assert done.equal
    assert 1 < done.outcomes[0].ticks < 9
