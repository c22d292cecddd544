"""What a screen beside a run is given: what the log has, to the byte."""

from __future__ import annotations

from pathlib import Path

import pytest

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.codec.codecs import CommandCodec
from space_robot_msgs_py.codec.sender_mark import SenderMark
from space_robot_msgs_py.log.preamble import RECORDED
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import BASE_ODOM, JOINT_COMMAND, REFERENCE_BASE, TABLE, Topic
from space_robot_report.live.brief import Brief
from space_robot_report.live.feed import Feed, Message

TOPICS = {topic.name: topic for topic in TABLE}
FAULT = ["supervision=mini_basic", "faults=[{kind: joint_stuck, joint: joint2, at: 1.0}]"]


def logged(folder: Path, *overrides: str) -> LogReader:
    """The log of a short run."""
    spec = load_experiment("liu2023/fig08", ["duration=5.0", "expect={}", *overrides])
    run_experiment(spec, folder / "run", mode="headless")
    return LogReader(folder / "run")


def brief_of(log: LogReader) -> Brief:
    """Of the run of a log."""
    header = log.header
    return Brief("run", "a run", header.joint_names, header.urdf, header.topics)


def messages(log: LogReader) -> list[Message]:
    """All of a log but what it says once."""
    found = [(TOPICS[name], stamp, data) for name, stamp, data in log.messages()]
    return [message for message in found if not message[0].latched]


def fed(feed: Feed, given: list[Message]) -> list[Message]:
    """What comes out of it where what nodes publish goes in."""
    return [one for topic, _, data in given if topic in feed.topics for one in feed.read(topic, data)]


def ordered(found: list[Message]) -> list[Message]:
    """By stamp and topic: derived messages come as soon as what they follow from."""
    return sorted(found, key=lambda message: (message[1], RECORDED.index(message[0])))


@pytest.mark.parametrize("overrides", [[], FAULT], ids=["plain", "supervised"])
def test_a_screen_gets_what_the_log_has(overrides: list[str], tmp_path: Path) -> None:
    """Every message with its stamp and bytes, transforms and angles among them, events where there are any."""
    log = logged(tmp_path, *overrides)
    feed = Feed(brief_of(log))
    assert ordered(fed(feed, messages(log))) == ordered(messages(log))
    assert feed.refused == 0
    still = [data for name, _, data in log.messages() if name == "/tf_static"]
    assert still == [feed.static]


def test_what_is_said_again_is_no_news(tmp_path: Path) -> None:
    """States and references that wait are said again on the graph, and once in the log."""
    log = logged(tmp_path)
    feed, given = Feed(brief_of(log)), messages(log)
    assert fed(feed, [message for message in given for _ in range(2)]) == fed(Feed(brief_of(log)), given)


def test_a_run_that_is_reset_is_news(tmp_path: Path) -> None:
    """Time begins again, and everything is said once more."""
    log = logged(tmp_path)
    feed = Feed(brief_of(log))
    once = fed(feed, messages(log))
    assert fed(feed, messages(log)) == once


def test_marks_of_senders_and_dirt_are_cleaned_away(tmp_path: Path) -> None:
    """As in the log; what is no message of its topic is counted, and nothing comes of it."""
    log = logged(tmp_path)
    feed, codec = Feed(brief_of(log)), CommandCodec(log.header.joint_names)
    of_topic = [(topic, data) for topic, _, data in messages(log) if topic is JOINT_COMMAND]
    topic, data = of_topic[0]
    index = codec.topics.index(JOINT_COMMAND)
    marked = SenderMark(codec.layouts).put([data if one == index else bytes(200) for one in range(2)], b"xy")[index]
    assert marked != data
    assert list(feed.read(topic, marked)) == [(topic, 0, data)]
    for wrong in (b"", b"\x00\x01\x00\x00", data[:-1]):
        assert list(feed.read(BASE_ODOM, wrong)) == []
    assert feed.refused == 3


def test_it_remembers_the_newest(tmp_path: Path) -> None:
    """By stamp, for so long as a state may wait for its reference."""
    log = logged(tmp_path)
    feed = Feed(brief_of(log))
    given = messages(log)
    fed(feed, given)
    last = given[-1][1]

    def of(topic: Topic, stamp: int) -> bytes:
        return next(data for one, at, data in given if one is topic and at == stamp)

    assert feed.newest(BASE_ODOM) == (last, of(BASE_ODOM, last))
    assert feed.at(REFERENCE_BASE, last) == of(REFERENCE_BASE, last)
    assert feed.at(BASE_ODOM, last + 1) is None
