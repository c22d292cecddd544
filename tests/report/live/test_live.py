"""A run that is shown while it goes on: what is seen is what is logged, and looking changes no bit of it."""

from __future__ import annotations

import os
import socket
import subprocess
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from threading import Thread
from time import monotonic, sleep
from typing import Any

import pytest

pytest.importorskip("rclpy")
pytest.importorskip("foxglove")
pytest.importorskip("websockets")
from websockets.exceptions import ConnectionClosed

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.run import run_composition, run_experiment
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.preamble import log_name
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import TABLE, Topic
from space_robot_report.live import companion
from space_robot_report.live.brief import Brief
from space_robot_report.live.companion import shown_live
from space_robot_report.live.feed import Feed
from space_robot_report.nodes.listener import Listener
from tests.support.follow import DEADLINE
from tests.support.foxglove_client import FoxgloveClient
from tests.support.harness import RunningGraph, running_graph
from tests.support.tool import Tool

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
TOPICS = {topic.name: topic for topic in TABLE}
SHORT = ["duration=10.0", "expect={}"]


def logged(place: Path) -> set[tuple[str, int, bytes]]:
    """All messages of a log by their names in it."""
    return {(log_name(TOPICS[name]), stamp, data) for name, stamp, data in LogReader(place).messages()}


def brief_of() -> Brief:
    """Of the run of an experiment, for Foxglove at a free port."""
    header = compose(load_experiment("liu2023/fig08", SHORT)).header
    return Brief("run", "", header.joint_names, header.urdf, header.topics, foxglove=0)


def await_matches(robot: RunningGraph, topics: Iterable[Topic]) -> None:
    """Wait until every publisher of the topics, of the run's nodes, has found all who listen, the viewer among them."""
    names, end = {topic.name for topic in topics}, monotonic() + DEADLINE
    publishers = [
        (node, publisher)
        for node in robot.nodes.values()
        for publisher in node.publishers
        if publisher.topic_name.lstrip("/") in names
    ]
    assert publishers
    for node, publisher in publishers:
        while True:
            listening = [one.node_name for one in node.get_subscriptions_info_by_topic(publisher.topic_name)]
            if "viewer" in listening and publisher.get_subscription_count() == len(listening):
                break
            assert monotonic() < end, f"waited {DEADLINE} s for the viewer of {publisher.topic_name}: {listening}"
            sleep(0.01)


def test_a_listener_hears_what_the_log_has(tmp_path: Path) -> None:
    """In lock-step, in one process; the log is that of a run without a listener."""
    place, feed, heard = tmp_path / "run", Feed(brief_of()), []
    with running_graph(place, *SHORT) as robot:
        listener = Listener(robot.context, feed.topics)
        await_matches(robot, feed.topics)
        robot.spin_until(lambda: robot.recorder.end_reason, "the end of the run")
        robot.settle()
        for topic, raw in listener.take():
            heard += [(log_name(one), stamp, data) for one, stamp, data in feed.read(topic, raw)]
        robot.recorder.finish(str(robot.recorder.end_reason))
        listener.close()
    assert len(heard) == len(set(heard))
    said = {one for one in logged(place) if one[0] not in ("/robot_description", "/tf_static")}
    assert set(heard) <= said
    # References are out ahead of their states, the first of them before a listener is matched.
    assert {topic for topic, _, _ in said - set(heard)} <= {topic for topic, _, _ in said if "/reference/" in topic}
    run_experiment(load_experiment("liu2023/fig08", SHORT), tmp_path / "alone" / "run", mode="headless")
    assert list(LogReader(tmp_path / "alone" / "run").messages()) == list(LogReader(place).messages())


def test_a_run_is_served_to_foxglove_while_it_goes_on(tmp_path: Path) -> None:
    """By a process beside it: a client hears messages of the log, all of them from the first that it heard."""
    clients: list[FoxgloveClient] = []

    def follow(address: str) -> None:
        clients.append(FoxgloveClient(address))
        # Until the server is gone with the run.
        with suppress(ConnectionClosed):
            clients[0].receive_until(lambda: False)

    def stamps() -> list[int]:
        return [stamp for topic, stamp, _ in clients[0].messages if topic == "/base/odom"] if clients else []

    def enough() -> str | None:
        assert monotonic() < deadline, "waited in vain for ten states to be served"
        return "enough" if len(stamps()) > 10 else None

    before, deadline = os.environ.get("ROS_DOMAIN_ID"), monotonic() + DEADLINE
    composition = compose(load_experiment("liu2023/fig08", ["duration=25000.0", "expect={}"]))
    with shown_live(brief_of()) as addresses:
        follower = Thread(target=follow, args=(addresses["foxglove"],))
        follower.start()
        run_composition(composition, tmp_path / "run", mode="graph", realtime=5.0, hooks=Hooks(stop=enough))
    follower.join()
    assert os.environ.get("ROS_DOMAIN_ID") == before
    assert stamps() == sorted(set(stamps()))
    # The run is ended in the middle of a tick: of the last ones the log may lack what was said of them.
    ended = max(stamp for _, stamp, _ in logged(tmp_path / "run"))
    assert {one for one in clients[0].messages if one[1] < ended} <= logged(tmp_path / "run")


def test_a_process_that_cannot_show_refuses_the_run_in_one_line() -> None:
    """A port that is taken, before anything is run."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        brief = replace(brief_of(), foxglove=taken.getsockname()[1])
        with pytest.raises(SpecError, match=r"cannot be shown.*--foxglove"), shown_live(brief):
            pytest.fail("it was shown")


@pytest.mark.parametrize("module", ["viser", "foxglove"])
def test_what_is_not_installed_is_named(module: str, space_robot: Tool, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the advice how to install it, and nothing was run."""
    found: Callable[[str], Any] = lambda name: None if name == module else find_spec(name)  # noqa: E731
    monkeypatch.setattr(companion, "find_spec", found)
    done = space_robot("run", "liu2023/fig08", "--mode", "graph", "--view", "--no-browser", "--foxglove", "8765")
    assert done.returncode == 2
    assert f"needs {module}" in done.stderr
    assert "pip install" in done.stderr
    assert not Path("runs").exists()


def test_a_headless_run_has_no_graph_to_serve(space_robot: Tool) -> None:
    """It is refused before it runs."""
    done = space_robot("run", "liu2023/fig08", "--foxglove", "8765")
    assert (done.returncode, done.stdout) == (2, "")
    assert "--foxglove: has no graph; got 8765; accepted: --mode graph or processes" in done.stderr


def test_a_run_goes_on_where_its_screen_dies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The process beside it is killed in mid-run: the run completes, and its log is whole."""
    children: list[subprocess.Popen[str]] = []
    started = companion._started
    monkeypatch.setattr(companion, "_started", lambda *given: children.append(started(*given)) or children[-1])
    with shown_live(brief_of()):
        children[0].kill()
        children[0].wait()
        result = run_composition(compose(load_experiment("liu2023/fig08", SHORT)), tmp_path / "run", mode="graph")
    assert result.end_reason == "completed"
    assert len(logged(tmp_path / "run")) > 41 * 10
