"""Topics, counts, rates, gaps, provenance, damage and verdict of any bag."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.judge.verdict import Check
from space_robot_bringup.logs.logged import compose_logged, logged_experiment
from space_robot_bringup.modes.run import judge_ticks
from space_robot_description.load import load_robot
from space_robot_msgs_py.bounded_files import is_file
from space_robot_msgs_py.errors import InputFileError, LogError, SpaceRobotError
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_msgs_py.log.bag import Bag
from space_robot_msgs_py.log.directory import custom_data
from space_robot_msgs_py.log.mcap.salvage import Damage
from space_robot_msgs_py.log.reader import LogReader

# An interval that is so many times the median is a gap.
GAP = 1.5


@dataclass(frozen=True, slots=True)
class TopicInfo:
    """One topic of a bag; times are those of the recording.

    Attributes:
        name: as in the bag.
        type: ``package/msg/Name``.
        count: number of messages.
        first: time of the first [ns].
        last: time of the last [ns].
        rate: mean [Hz]; None for fewer than two.
        gaps: intervals longer than 1.5 times the median.
        longest_gap: [s]; 0 without gaps.
    """

    name: str
    type: str
    count: int
    first: int
    last: int
    rate: float | None
    gaps: int
    longest_gap: float


@dataclass(frozen=True, slots=True)
class Verdict:
    """How a run is judged from its log.

    Attributes:
        checks: bound by bound; none where it cannot be judged.
        why_not: why it cannot be judged, or nothing.
    """

    checks: tuple[Check, ...] = ()
    why_not: str = ""

    @property
    def passed(self) -> bool | None:
        """Every bound holds; None: it cannot be determined."""
        return all(check.passed for check in self.checks) if self.checks else None


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
        verdict: of the run.
    """

    path: Path
    size: int
    topics: tuple[TopicInfo, ...]
    provenance: Mapping[str, str]
    versions: Mapping[str, str]
    end_reason: str | None
    damage: tuple[Damage, ...]
    verdict: Verdict

    @property
    def messages(self) -> int:
        """On all topics."""
        return sum(topic.count for topic in self.topics)


def bag_info(path: Path) -> BagInfo:
    """Look at a bag, as far as it can be read.

    Raises:
        InputFileError: there is no bag, or nothing of it can be read.
    """
    bag = Bag(path)
    types: dict[str, str] = {}
    times: dict[str, array[int]] = {}
    damage: list[Damage] = []
    for item in bag.messages():
        if isinstance(item, Damage):
            damage.append(item)
            continue
        types.setdefault(item.topic, item.type)
        times.setdefault(item.topic, array("Q")).append(item.time)
    topics = tuple(_topic(name, types[name], stamps) for name, stamps in times.items())
    files = [path] if is_file(path) else [file for file in path.iterdir() if is_file(file)]
    size = sum(file.stat().st_size for file in files)
    provenance, versions, reason, verdict = _own(bag)
    return BagInfo(path, size, topics, provenance, versions, reason, tuple(damage), verdict)


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
    try:
        reader = LogReader(bag.path)
    except (LogError, InputFileError) as error:
        return {}, {}, None, Verdict(why_not=f"no experiment in it ({error.message})")
    provenance = {"seed": str(reader.header.seed)} | custom_data(reader.path)
    provenance.pop("end_reason", None)
    try:
        experiment = logged_experiment(reader.header.experiment)
        provenance = _words(experiment) | provenance
        reason = reader.end_reason
        return provenance, reader.header.versions, reason, _verdict(reader, experiment, reason)
    except SpaceRobotError as error:
        return provenance, reader.header.versions, None, Verdict(why_not=str(error))


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
    ticks = list(reader.ticks())
    if not ticks:
        return Verdict(why_not="no complete tick")
    return Verdict(judge_ticks(ticks, compose_logged(experiment), reason or "cut")[1])
