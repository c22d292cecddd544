"""How a replay looks: lines for people, one dictionary for programs."""

from __future__ import annotations

from math import isfinite
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from space_robot_bringup.replay.comparison import Comparison, Divergence, Value
from space_robot_bringup.replay.publish import Answers
from space_robot_bringup.replay.replay import Replayed
from space_robot_bringup.replay.result import Outcome
from space_robot_cli.terminal import markup
from space_robot_msgs_py.bounded_files import short
from space_robot_msgs_py.interfaces import NANOSECONDS


def print_replayed(console: Console, done: Replayed) -> None:
    """Print what was changed, and for each side the verdict, the first difference and the worst ones."""
    recording, experiment = done.recording, done.recording.composition.experiment
    end = recording.end_reason or "cut, or of another tool"
    name = f"{experiment.controller.law} on {recording.composition.nominal.name}, seed {experiment.seed}; ended: {end}"
    _say(console, f"{recording.path}: {name}")
    for key, (was, now) in recording.changes.items():
        _say(console, f"  changed: {key} was {short(str(was))}, is {short(str(now))}")
    for package, (was, now) in recording.versions.items():
        _say(console, f"  recorded with {package} {was}, here {now}")
    for remark in recording.remarks:
        _say(console, f"  note: {remark}")
    for outcome in done.outcomes:
        _side(console, outcome)


def _side(console: Console, outcome: Outcome) -> None:
    word, style = ("EQUAL", "bold green") if outcome.equal else ("DIFFERENT", "bold red")
    span = f"{outcome.ticks} ticks to {outcome.last / NANOSECONDS:g} s"
    counts = sum(outcome.comparison.compared.values())
    _say(console, f"{outcome.against}: {word}, {counts} messages of {span}", style)
    for remark in outcome.remarks:
        _say(console, f"  note: {remark}")
    if outcome.absent:
        _say(console, f"  not in the log, so not compared: {', '.join(outcome.absent)}")
    if outcome.first is not None:
        _say(console, f"  first: {in_words(outcome.first)}")
        console.print(_worst(outcome.comparison))


def print_answers(console: Console, answers: Answers, reason: str) -> None:
    """Print how a run on the live graph ended and how the answers to it differ from the recorded commands."""
    comparison = answers.comparison
    _say(console, f"ended: {reason}")
    if answers.unusable:
        _say(console, f"{answers.unusable} answers were no valid commands", "red")
    if not comparison.compared:
        _say(console, "no recorded command was answered, so nothing was compared")
        return
    word, style = ("DIFFERENT", "bold red") if answers.different else ("EQUAL", "bold green")
    _say(console, f"answers: {word}, {sum(comparison.compared.values())} messages", style)
    if comparison.first is not None:
        _say(console, f"  first: {in_words(comparison.first)}")
        console.print(_worst(comparison))


def in_words(found: Divergence) -> str:
    """Where two numbers differ, and which they are."""
    when = f"{found.stamp / NANOSECONDS:g} s ({found.stamp} ns)"
    return f"{found.topic} at {when}, {found.field}: recorded {_text(found.recorded)}, fresh {_text(found.fresh)}"


def _text(value: Value) -> str:
    return repr(value) if isinstance(value, float) else str(value)


def _worst(comparison: Comparison) -> Table:
    table = Table(box=SIMPLE_HEAD)
    for heading in ("topic", "worst field", "at [s]", "recorded", "fresh", "difference", "messages"):
        table.add_column(heading, justify="left" if heading in ("topic", "worst field") else "right")
    for place, found in comparison.worst.items():
        values = [f"{value:.9g}" if isinstance(value, float) else str(value) for value in (found.recorded, found.fresh)]
        distance = f"{found.distance:.2e}" if isfinite(found.distance) else "-"
        count = str(comparison.differing[place])
        cells = (found.topic, found.field, f"{found.stamp / NANOSECONDS:g}", *values, distance, count)
        table.add_row(*map(markup, cells))
    return table


def _say(console: Console, line: str, style: str | None = None) -> None:
    console.print(line, style=style, markup=False, soft_wrap=True)


def as_dict(done: Replayed) -> dict[str, Any]:
    """The same as plain data; absent numbers are None, none is NaN."""
    recording = done.recording
    return {
        "bag": str(recording.path),
        "equal": done.equal,
        "end_reason": recording.end_reason,
        "changes": {key: {"recorded": was, "now": now} for key, (was, now) in recording.changes.items()},
        "versions": {key: {"recorded": was, "here": now} for key, (was, now) in recording.versions.items()},
        "remarks": list(recording.remarks),
        "replays": [_outcome(outcome) for outcome in done.outcomes],
    }


def _outcome(outcome: Outcome) -> dict[str, Any]:
    comparison = outcome.comparison
    return {
        "against": outcome.against,
        "equal": outcome.equal,
        "ticks": outcome.ticks,
        "last_stamp": outcome.last,
        "compared": dict(comparison.compared),
        "absent": list(outcome.absent),
        "remarks": list(outcome.remarks),
        "first": None if comparison.first is None else _divergence(comparison.first),
        "worst": [_divergence(d) | {"messages": comparison.differing[p]} for p, d in comparison.worst.items()],
    }


def _divergence(found: Divergence) -> dict[str, Any]:
    return {
        "topic": found.topic,
        "stamp": found.stamp,
        "field": found.field,
        "recorded": _plain(found.recorded),
        "fresh": _plain(found.fresh),
    }


def _plain(value: Value) -> Value:
    """JSON has no NaN and no infinity: those become words."""
    return value if not isinstance(value, float) or isfinite(value) else repr(value)
