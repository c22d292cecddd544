"""Which profile Fast DDS reads: one with which nodes that start together find each other at once, or the user's."""

from __future__ import annotations

import os
from pathlib import Path
from xml.etree import ElementTree

import pytest

pytest.importorskip("rclpy")

from space_robot_bringup.modes.context import DISCOVERY, PROFILE_FILES, PROFILE_VARIABLES, private_context

pytestmark = pytest.mark.ros


@pytest.fixture(autouse=True)
def bare(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A user who has chosen nothing."""
    monkeypatch.chdir(tmp_path)
    for name in PROFILE_VARIABLES:
        # Set before it is removed: what the test makes of it goes, too.
        monkeypatch.setenv(name, "")
        monkeypatch.delenv(name)


def chosen() -> list[str | None]:
    """What the variables say inside a context."""
    with private_context():
        return [os.environ.get(name) for name in PROFILE_VARIABLES]


def test_ours_is_read_where_there_is_no_other(capfd: pytest.CaptureFixture[str]) -> None:
    """It is named to Fast DDS, which takes it without a word, and announces a participant for seconds."""
    assert chosen() == [str(DISCOVERY), None]
    assert capfd.readouterr().err == ""
    space = {"": "http://www.eprosima.com"}
    announcements = ElementTree.parse(DISCOVERY).find(".//initialAnnouncements", space)
    assert announcements is not None
    count, nanoseconds = (announcements.findtext(name, "", space) for name in ("count", "period/nanosec"))
    assert int(count) * int(nanoseconds) * 1e-9 >= 3.0


def test_readers_are_asked_for_what_they_lack_by_the_clock_and_not_with_every_message() -> None:
    """A lost message is repaired within a second; a writer whose history is full gets no answer to each of its own."""
    space = {"": "http://www.eprosima.com"}
    writer = ElementTree.parse(DISCOVERY).find(".//data_writer[@is_default_profile='true']", space)
    assert writer is not None
    assert writer.findtext("qos/disable_heartbeat_piggyback", "", space) == "true"
    asked, deaf = (
        1e-9 * int(writer.findtext(f"times/{name}/nanosec", "", space))
        for name in ("heartbeatPeriod", "nackSupressionDuration")
    )
    assert 0.0 < deaf < asked <= 0.5


@pytest.mark.parametrize("name", PROFILE_VARIABLES)
def test_a_profile_of_the_user_stays(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str) -> None:
    """A variable that is set is left as it is, and no other is added."""
    monkeypatch.setenv(name, str(tmp_path / "mine.xml"))
    assert chosen().count(None) == 1
    assert os.environ[name] == str(tmp_path / "mine.xml")


@pytest.mark.parametrize("name", PROFILE_FILES)
def test_a_file_in_the_working_directory_stays(tmp_path: Path, name: str) -> None:
    """Fast DDS reads these names where it is started; ours would be a second default."""
    (tmp_path / name).write_bytes(DISCOVERY.read_bytes())
    assert chosen() == [None, None]
