"""Short runs and what a replay of them must say."""

from __future__ import annotations

from pathlib import Path

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import Mode, run_experiment
from space_robot_bringup.replay.comparison import Divergence
from space_robot_bringup.replay.replay import Replayed, ReplayOptions, replay
from space_robot_bringup.replay.result import Outcome
from space_robot_msgs_py.codec.codecs import LOGGED, decode_events, encode_events
from space_robot_msgs_py.events import PUBLISHERS
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogWriter
from space_robot_msgs_py.topics import CONTROLLER_EVENTS


def record_run(place: Path, experiment: str, *overrides: str, mode: Mode = "headless") -> Path:
    """Run a shipped experiment into a run directory."""
    run_experiment(load_experiment(experiment, overrides), place, mode=mode)
    return place


def replayed(bag: Path, **options: object) -> Replayed:
    """What comes out of a bag."""
    return replay(bag, ReplayOptions(**options))  # type: ignore[arg-type]


def assert_equal(bag: Path) -> None:
    """Controller and plant give every message of every tick again, bit for bit."""
    done = replayed(bag)
    for outcome in done.outcomes:
        assert outcome.first is None, (outcome.against, outcome.first)
        assert outcome.absent == ()
        assert outcome.remarks == ()
        assert len(set(outcome.comparison.compared.values())) == 1
    assert [outcome.against for outcome in done.outcomes] == ["controller", "plant"]


def but_for_publishers(bag: Path) -> list[tuple[str, int, bytes]]:
    """The messages of a bag without the recorder's events of who publishes.

    A recorder looks once a second: where a test publishes on a topic of a tick, too, it is a matter of time whether the
    log of a run that goes on says so, and at which tick.
    """
    found = []
    for name, stamp, data in LogReader(bag).messages():
        if name == CONTROLLER_EVENTS.name:
            events = [event for event in decode_events(data) if event.kind != PUBLISHERS]
            found += [(name, stamp, encode_events(events))] if events else []
        else:
            found.append((name, stamp, data))
    return found


def rewritten(source: Path, place: Path, change: object = None, drop: tuple[str, ...] = (), end: str = "") -> Path:
    """A copy of a log; ``change(stamp, parts)`` may alter the messages of a stamp, or leave it out by None."""
    reader = LogReader(source)
    writer = LogWriter(place, reader.header)
    writer.write_description(reader.header.urdf)
    for stamp, parts in reader.stamps():
        kept = {name: raw for name, raw in parts.items() if name not in drop}
        altered = change(stamp, kept) if callable(change) else kept
        if altered is not None:
            writer.write_tick(stamp, {topic: altered[topic.name] for topic in LOGGED if topic.name in altered})
    writer.close(end or reader.end_reason or "cut")
    return place


def one(done: Replayed) -> Outcome:
    (outcome,) = done.outcomes
    return outcome


def first(outcome: Outcome) -> Divergence:
    assert outcome.first is not None
    return outcome.first
