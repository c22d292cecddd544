"""Topics, counts, rates, gaps, provenance, damage and verdict of any bag."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.conclusion import conclusion, passed
from space_robot_bringup.judge.judging import judge_blocks
from space_robot_bringup.judge.remarks import Remark
from space_robot_bringup.logs.commander import external_nodes
from space_robot_bringup.logs.happened import SEVERITIES, Witness
from space_robot_bringup.logs.logged import compose_logged, logged_experiment
from space_robot_bringup.logs.spans import NO_SPANS, Spans
from space_robot_description.load import load_robot
from space_robot_msgs_py.bounded_files import is_file
from space_robot_msgs_py.errors import InputFileError, LogError, SpaceRobotError
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_msgs_py.log.bag import Bag, BagMessage, Missing
from space_robot_msgs_py.log.blocks import BlockStacker
from space_robot_msgs_py.log.directory import custom_data
from space_robot_msgs_py.log.mcap.salvage import Damage
from space_robot_msgs_py.log.mcap.summary import Summary, SummaryTopic, read_summary
from space_robot_msgs_py.log.preamble import END_NAME
from space_robot_msgs_py.log.reader import LogReader
from space_robot_supervisor.rows import Severity

# Larger bags are looked at by their index [bytes].
LARGE = 64 << 20
# An interval that is so many times the median is a gap.
GAP = 1.5


@dataclass(frozen=True, slots=True)
class TopicInfo:
    """One topic of a bag; times are those of the recording.

    Attributes:
        name: as in the bag.
        type: ``package/msg/Name``, and the encoding where it is not that of ROS.
        count: number of messages.
        first: time of the first [ns].
        last: time of the last [ns].
        rate: mean [Hz]; None for fewer than two.
        gaps: intervals longer than 1.5 times the median; None: not looked for.
        longest_gap: [s]; 0 without gaps.
    """

    name: str
    type: str
    count: int
    first: int
    last: int
    rate: float | None
    gaps: int | None
    longest_gap: float


@dataclass(frozen=True, slots=True)
class Verdict:
    """How a run is judged from its log, and what happened in it.

    Attributes:
        checks: bound by bound; none where it cannot be judged.
        why_not: why it cannot be judged, or nothing.
        remarks: what else happened, whatever was expected.
        spans: its modes and faults.
        events: how many there were of each severity, of those that there were, the gravest first.
        commanders: nodes of other projects that commanded.
    """

    checks: tuple[Check, ...] = ()
    why_not: str = ""
    remarks: tuple[Remark, ...] = ()
    spans: Spans = NO_SPANS
    events: Mapping[Severity, int] = field(default_factory=dict)
    commanders: tuple[str, ...] = ()

    @property
    def passed(self) -> bool | None:
        """See ``RunResult.passed``; None also where it cannot be determined."""
        return passed(self.checks) if self.checks else None

    @property
    def conclusion(self) -> str:
        """``PASS``, ``FAIL``, or in words that nothing was expected; empty where it cannot be determined."""
        return conclusion(self.checks) if self.checks else ""


@dataclass(frozen=True, slots=True)
class BagInfo:
    """What is in a bag.

    Attributes:
        path: as given.
        size: of its files [bytes].
        topics: in the order of their first messages.
        provenance: title, robot, law, seed, ... of a run log; empty for a bag of another tool.
        versions: of everything that can change the bits of a run.
        end_reason: None: it was cut, or is another tool's.
        damage: bytes that are lost.
        missing: messages by topic that the bag counts, at its end or in its description, and that were not read.
        verdict: of the run.
        by_index: only what the index of its files says is known, no message was looked at.
    """

    path: Path
    size: int
    topics: tuple[TopicInfo, ...]
    provenance: Mapping[str, str]
    versions: Mapping[str, str]
    end_reason: str | None
    damage: tuple[Damage, ...]
    missing: Mapping[str, int]
    verdict: Verdict
    by_index: bool = False

    @property
    def messages(self) -> int:
        """On all topics."""
        return sum(topic.count for topic in self.topics)


def bag_info(path: Path, *, full: bool = False) -> BagInfo:
    """Look at a bag, as far as it can be read.

    A large bag is looked at by its index, which takes a second whatever its size. Gaps, damage and the verdict need
    every message.

    Args:
        path: of a bag of any tool.
        full: look at every message of a large bag, too.

    Raises:
        InputFileError: there is no bag, or nothing of it can be read.
    """
    bag = Bag(path)
    if not full and sum(file.stat().st_size for file in bag.files) > LARGE:
        summaries = [summary for file in bag.files if (summary := read_summary(file)) is not None]
        if len(summaries) == len(bag.files):
            with suppress(LogError):
                return _by_index(bag, summaries)
    types: dict[str, str] = {}
    times: dict[str, array[int]] = {}
    damage, missing = list[Damage](), Counter[str]()
    for item in bag.messages():
        if isinstance(item, Damage):
            damage.append(item)
        elif isinstance(item, Missing):
            missing[item.topic] += item.count
        else:
            types.setdefault(item.topic, _type(item))
            times.setdefault(item.topic, array("Q")).append(item.time)
    topics = tuple(_topic(name, types[name], stamps) for name, stamps in times.items())
    provenance, versions, reason, verdict = _own(bag)
    return BagInfo(path, _size(path), topics, provenance, versions, reason, tuple(damage), missing, verdict)


def _type(message: BagMessage) -> str:
    """The type of a message, and its encoding where it is not that of ROS."""
    return message.type if message.encoding in ("cdr", "") else f"{message.type} ({message.encoding})".strip()


def _by_index(bag: Bag, summaries: Sequence[Summary]) -> BagInfo:
    """What the indices of all files of a bag say.

    Raises:
        LogError: one is damaged.
    """
    parts: dict[str, list[SummaryTopic]] = {}
    reason = None
    for summary in summaries:
        for topic in summary.topics():
            parts.setdefault(topic.name, []).append(topic)
        reason = summary.metadata().get(END_NAME, {}).get("reason", reason)
    topics = tuple(_merged(found) for found in parts.values())
    provenance, versions, _ = _provenance(bag)
    verdict = Verdict(why_not=f"more than {LARGE >> 20} MiB: --full looks at every message")
    ended = reason if provenance else None
    found = Counter({topic.name: topic.count for topic in topics})
    missing = Counter(bag.counted()) - found
    return BagInfo(bag.path, _size(bag.path), topics, provenance, versions, ended, (), missing, verdict, by_index=True)


def _merged(parts: Sequence[SummaryTopic]) -> TopicInfo:
    """One topic out of the files of a bag."""
    count = sum(part.count for part in parts)
    first, last = min(part.first for part in parts), max(part.last for part in parts)
    span = (last - first) / NANOSECONDS
    return TopicInfo(parts[0].name, parts[0].type, count, first, last, (count - 1) / span if span else None, None, 0.0)


def _size(path: Path) -> int:
    files = [path] if is_file(path) else [file for file in path.iterdir() if is_file(file)]
    return sum(file.stat().st_size for file in files)


def _topic(name: str, ros_type: str, times: Sequence[int]) -> TopicInfo:
    stamps = np.asarray(times, dtype=np.uint64)
    steps = np.diff(np.sort(stamps)).astype(np.float64) / NANOSECONDS
    first, last = int(stamps.min()), int(stamps.max())
    span = (last - first) / NANOSECONDS
    gaps = steps[steps > GAP * np.median(steps)] if steps.size else steps
    longest = float(np.max(gaps, initial=0.0))
    rate = steps.size / span if span else None
    return TopicInfo(name, ros_type, len(times), first, last, rate, int(gaps.size), longest)


def _own(bag: Bag) -> tuple[dict[str, str], dict[str, str], str | None, Verdict]:
    """What only a log of this project says about itself."""
    provenance, versions, found = _provenance(bag)
    if isinstance(found, Verdict):
        return provenance, versions, None, found
    reader, experiment = found
    reason = None
    try:
        reason = reader.end_reason
        verdict = _verdict(reader, experiment, reason)
        if verdict.commanders:
            provenance["commanded by"] = ", ".join(verdict.commanders)
        return provenance, versions, reason, verdict
    except SpaceRobotError as error:
        return provenance, versions, reason, Verdict(why_not=str(error))


def _provenance(bag: Bag) -> tuple[dict[str, str], dict[str, str], tuple[LogReader, Experiment] | Verdict]:
    """What stands in front of the messages, and what was run, or why that is not known."""
    try:
        reader = LogReader(bag.path)
    except (LogError, InputFileError) as error:
        return {}, {}, Verdict(why_not=f"no experiment in it ({error.message})")
    provenance = {"seed": str(reader.header.seed)} | custom_data(reader.path)
    provenance.pop("end_reason", None)
    try:
        experiment = logged_experiment(reader.header.experiment)
        return _words(experiment) | provenance, reader.header.versions, (reader, experiment)
    except SpaceRobotError as error:
        return provenance, reader.header.versions, Verdict(why_not=str(error))


def _words(experiment: Experiment) -> dict[str, str]:
    words = {
        "title": experiment.title,
        "source": experiment.source,
        "robot": load_robot(experiment.robot).name,
        "law": experiment.controller.law,
        "plant": experiment.plant.kind,
        "control period": f"{experiment.control_period:g} s",
        "duration": f"{experiment.duration:g} s",
    }
    return {name: text for name, text in words.items() if text}


def _verdict(reader: LogReader, experiment: Experiment, reason: str | None) -> Verdict:
    witness = Witness(reader.rows())
    blocks = BlockStacker(reader.header.joint_names, str(reader.path)).blocks(witness.rows())
    found = judge_blocks(blocks, compose_logged(experiment), reason or "cut")
    if found.metrics is None:
        return Verdict(why_not="no complete tick")
    counts = Counter(event.severity for event in witness.events)
    events = {severity: counts[severity] for severity in reversed(SEVERITIES) if counts[severity]}
    spans = Spans.of(witness.events, experiment, found.metrics.simulated_time)
    return Verdict(found.checks, "", found.remarks, spans, events, external_nodes(witness.events))
