"""A run for Foxglove, seen by a client of another project."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import pytest

pytest.importorskip("foxglove")
pytest.importorskip("websockets")

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_description.load import load_robot
from space_robot_msgs_py.codec.schemas import schema_text
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.preamble import channels_of, log_name
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import TABLE
from space_robot_report.live.bridge import FoxgloveBridge
from space_robot_report.live.brief import Brief
from space_robot_report.live.feed import Feed
from tests.support.foxglove_client import ASSET, FoxgloveClient

HOSTILE = "<img src=x onerror=alert(1)>\x1b[31m"
TOPICS = {topic.name: topic for topic in TABLE}
MESH = "package://example-robot-data/robots/ur_description/meshes/ur5/visual/base.dae"


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> LogReader:
    place = tmp_path_factory.mktemp("live") / "run"
    spec = load_experiment("liu2023/fig08", ["duration=5.0", "expect={}", "supervision=mini_basic"])
    run_experiment(spec, place, mode="headless")
    return LogReader(place)


def brief_of(log: LogReader) -> Brief:
    """Of the run of a log, at a free port."""
    return Brief(HOSTILE, "", log.header.joint_names, log.header.urdf, log.header.topics, foxglove=0)


@contextmanager
def bridged(brief: Brief) -> Iterator[tuple[FoxgloveBridge, FoxgloveClient]]:
    """A bridge and a client that has heard what is there."""
    bridge = FoxgloveBridge(brief, Feed(brief).static)
    client = FoxgloveClient(bridge.address)
    client.receive_until(lambda: len(client.messages) == 2)
    try:
        yield bridge, client
    finally:
        client.close()
        bridge.close()


def test_topics_schemas_and_bytes_are_those_of_the_log(log: LogReader) -> None:
    """A channel for each of the log, with the text of its type; every message with its bytes at its stamp."""
    with bridged(brief_of(log)) as (bridge, client):
        channels = channels_of(log.header)
        assert client.channels.keys() == {log_name(topic) for topic in channels}
        for topic in channels:
            said = client.channels[log_name(topic)]
            assert (said["encoding"], said["schemaEncoding"]) == ("cdr", "ros2msg")
            assert (said["schemaName"], said["schema"]) == (topic.type, schema_text(topic.type))
        expected = [(log_name(TOPICS[name]), stamp, data) for name, stamp, data in log.messages()]
        for name, stamp, data in log.messages():
            if not TOPICS[name].latched:
                bridge.say(TOPICS[name], stamp, data)
        client.receive_until(lambda: len(client.messages) == len(expected))
        assert sorted(client.messages[:2]) == sorted(expected[:2])
        assert client.messages[2:] == expected[2:]


def test_a_late_client_gets_the_description(log: LogReader) -> None:
    """What is said once is there for everyone, whenever they come."""
    with bridged(brief_of(log)) as (bridge, first):
        late = FoxgloveClient(bridge.address)
        late.receive_until(lambda: len(late.messages) == 2)
        late.close()
        assert {topic for topic, _, _ in late.messages} == {"/robot_description", "/tf_static"}
        assert {data for _, _, data in late.messages} == {data for _, _, data in first.messages[:2]}


def test_only_this_host_can_look_and_no_client_can_act(log: LogReader) -> None:
    """It listens on the loopback interface; clients may neither publish, call nor set anything."""
    with bridged(brief_of(log)) as (bridge, client):
        assert bridge.address.startswith("ws://127.0.0.1:")
        assert client.capabilities == ["assets"]
        port = int(bridge.address.rpartition(":")[2])
        with socket.socket() as other, pytest.raises(OSError, match=r"refused|unreachable"):
            # Another address of this host: only 127.0.0.1 is served.
            other.connect(("127.0.0.2", port))


def asset(client: FoxgloveClient, uri: str) -> tuple[int, bytes]:
    """Status and content of a file that is asked for."""
    client.send({"op": "fetchAsset", "uri": uri, "requestId": 7})
    while True:
        found = client.receive()
        if isinstance(found, bytes) and found[0] == ASSET:
            error_length = int.from_bytes(found[6:10], "little")
            return found[5], found[10 + error_length :]


def test_files_are_given_out_where_they_are_meshes_of_the_robot() -> None:
    """Its meshes as they are; no other file, whatever the URI, and none that a third-party robot names."""
    robot = load_robot("ur5_sat")
    names: Any = robot.joint_names
    brief = Brief("run", "", names, robot.urdf, foxglove=0)
    assert MESH in robot.urdf
    with bridged(brief) as (_, client):
        status, content = asset(client, MESH)
        assert status == 0
        assert content.startswith(b"<?xml")
        for uri in ("file:///etc/passwd", "/etc/passwd", MESH.replace("ur5/visual/base.dae", "../../../package.xml")):
            assert asset(client, uri)[0] == 1, uri
    with bridged(replace(brief, urdf=robot.urdf.replace(MESH, "file:///etc/passwd"))) as (_, client):
        assert asset(client, "file:///etc/passwd")[0] == 1


def test_a_port_that_is_taken_is_one_clear_error(log: LogReader) -> None:
    """With the option, the port, and what is accepted."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(SpecError, match=f"--foxglove.*{port}.*free"):
            FoxgloveBridge(replace(brief_of(log), foxglove=port), None)


def test_a_brief_survives_its_line() -> None:
    """What the parent says is what the process beside it hears."""
    brief = Brief(HOSTILE, "a\nb", ("j1", "j2"), "<robot/>", ("events",), "tool", ("/meshes",), 8080, None)
    assert "\n" not in brief.line()
    assert Brief.of_line(brief.line()) == brief
    assert json.loads(brief.line())["title"] == HOSTILE
