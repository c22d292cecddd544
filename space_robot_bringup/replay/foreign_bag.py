"""Bags of other tools: the project's topics out of them, by stamp, in the canonical bytes everything else expects."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from space_robot_msgs_py.codec.codecs import LOGGED, TopicBytes
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.log.arrays import Row
from space_robot_msgs_py.log.bag import Bag, intact
from space_robot_msgs_py.topics import BASE_ODOM, Topic

# Beyond, a stamp is no time of a run but one since 1970; telemetry cannot hold it either.
MAX_STAMP = 1 << 53


def foreign_rows(bag: Bag, joint_names: Sequence[str], namespace: str = "") -> tuple[list[Row], list[str]]:
    """Messages by stamp, and remarks on what was left out.

    Messages belong together by the stamps in them, in whatever order they were recorded.

    Args:
        bag: with topics of the project; others in it are not looked at.
        joint_names: the robot's joints in model order.
        namespace: in front of the topics.

    Raises:
        LogError: no topic of the project is in it, or it is corrupted in its middle.
    """
    names = {_absolute(topic, namespace): topic for topic in LOGGED}
    table: dict[int, dict[str, bytes]] = {}
    canonical, seen = TopicBytes(joint_names), set[str]()
    refused, twice, why = Counter[str](), Counter[str](), ""
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
        twice[topic.name] += topic.name in parts
        parts.setdefault(topic.name, data)
    if not table:
        raise _nothing(bag, namespace, seen)
    rows = sorted(table.items())
    if rows[-1][0] >= MAX_STAMP:
        accepted = "ns since the start of the run"
        raise LogError("its stamps are no times of a run", key=str(bag.path), value=rows[-1][0], accepted=accepted)
    remarks = [f"{count} messages on {name} cannot be read ({why})" for name, count in refused.items()]
    remarks += [f"{count} stamps came twice on {name}: the first counts" for name, count in twice.items() if count]
    return rows, remarks


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
