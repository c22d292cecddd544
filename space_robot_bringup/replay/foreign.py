"""Bags of other tools: our topics out of them, by stamp, in the canonical bytes everything else expects."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from space_robot_msgs_py.bag import Bag, intact
from space_robot_msgs_py.codecs import LOGGED, TopicBytes
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.log_arrays import Row
from space_robot_msgs_py.topics import BASE_ODOM, Topic

# Beyond, a stamp cannot be one of a run: it is a time since 1970, and the run is taken to begin at its first state.
LONGEST_RUN = 1 << 53


def foreign_rows(bag: Bag, joint_names: Sequence[str], namespace: str = "") -> tuple[list[Row], list[str]]:
    """Messages by stamp, and remarks on what was left out.

    Messages belong together by the stamps in them, in whatever order they were recorded.

    Args:
        bag: of our topics; others in it are not looked at.
        joint_names: the robot's joints in model order.
        namespace: in front of the topics.

    Raises:
        LogError: none of our topics is in it, or it is damaged in its middle.
    """
    names = {_absolute(topic, namespace): topic for topic in LOGGED}
    table: dict[int, dict[str, bytes]] = {}
    canonical, refused, seen = TopicBytes(joint_names), Counter[str](), set[str]()
    why = ""
    for message in intact(bag.messages(), str(bag.path)):
        seen.add(message.topic)
        topic = names.get(message.topic)
        if topic is None:
            continue
        try:
            stamp, data = canonical.read(topic, message.data)
        except SpaceRobotError as error:
            refused[topic.name] += 1
            why = why or str(error)
            continue
        parts = table.setdefault(stamp, {})
        refused[f"{topic.name}, whose stamp came before,"] += topic.name in parts
        parts.setdefault(topic.name, data)
    if not table:
        raise _nothing(bag, namespace, seen)
    remarks = [f"{count} messages on {name} were left out" for name, count in refused.items() if count]
    rows = sorted(table.items())
    return _from_zero(rows, remarks), remarks + ([f"the first of them: {why}"] if why else [])


def _from_zero(rows: list[Row], remarks: list[str]) -> list[Row]:
    """Wall times are refused with a reason; stamps of a run are left as they are."""
    if rows[-1][0] >= LONGEST_RUN:
        raise LogError(
            "its stamps are no times of a run", key=BASE_ODOM.name, value=rows[-1][0], accepted="ns since its start"
        )
    if rows[0][0]:
        remarks.append(f"it begins at {rows[0][0]} ns")
    return rows


def _absolute(topic: Topic, namespace: str) -> str:
    prefix = namespace.strip("/")
    return f"/{prefix}/{topic.name}" if prefix else f"/{topic.name}"


def _nothing(bag: Bag, namespace: str, seen: set[str]) -> LogError:
    """Say which topics there are, and the namespace that would have worked."""
    tail = f"/{BASE_ODOM.name}"
    spaces = sorted(name.removesuffix(tail) for name in seen if name.endswith(tail) and name != tail)
    accepted = f"--namespace {spaces[0].strip('/')}" if spaces else f"messages on {_absolute(BASE_ODOM, namespace)} ..."
    found = ", ".join(sorted(seen)) or "no message"
    return LogError("none of our topics is in it", key=str(bag.path), value=found, accepted=accepted)
