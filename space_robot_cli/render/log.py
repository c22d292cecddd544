"""How a bag and its recovery look: tables for people, one dictionary for programs."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from space_robot_bringup.logs.info import BagInfo, TopicInfo
from space_robot_cli.render.run import STYLES, missed
from space_robot_cli.terminal import markup
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_msgs_py.log.mcap.salvage import Damage
from space_robot_msgs_py.log.recover import Recovery


def print_info(console: Console, info: BagInfo) -> None:
    """Print provenance, topics, damage, reason of the end and verdict."""
    _say(console, f"{info.path}: {info.messages} messages on {len(info.topics)} topics, {info.size} bytes")
    for name, text in info.provenance.items():
        _say(console, f"  {name}: {text}")
    if info.versions:
        _say(console, "  versions: " + ", ".join(f"{name} {number}" for name, number in info.versions.items()))
    console.print(_topics(info))
    _damage(console, info.damage)
    for topic, count in info.missing.items():
        _say(console, f"missing: {count} messages on {topic}, which the bag counts at its end", "red")
    if info.by_index:
        _say(console, "by its index: gaps and damage were not looked for, --full does", "yellow")
    if info.provenance:
        _say(console, f"ended: {info.end_reason or 'the log was truncated'}")
    if info.verdict.events:
        counts = ", ".join(f"{count} {severity}" for severity, count in info.verdict.events.items())
        _say(console, f"events: {counts}; each with: space-robot events {info.path}")
    for line in info.verdict.spans.said:
        _say(console, line)
    missed(console, info.verdict.checks, info.verdict.remarks)
    if info.verdict.conclusion:
        _say(console, f"verdict: {info.verdict.conclusion}", STYLES[info.verdict.passed])
    else:
        _say(console, f"no verdict: {info.verdict.why_not}")


def _topics(info: BagInfo) -> Table:
    table = Table(box=SIMPLE_HEAD)
    for heading in ("topic", "type"):
        table.add_column(heading, no_wrap=True)
    for heading in ("messages", "rate [Hz]", "first [s]", "last [s]", "gaps", "longest [s]"):
        table.add_column(heading, justify="right")
    for topic in info.topics:
        table.add_row(*map(markup, _cells(topic)))
    return table


def _cells(topic: TopicInfo) -> tuple[str, ...]:
    return (
        topic.name,
        topic.type,
        str(topic.count),
        "-" if topic.rate is None else f"{topic.rate:.4g}",
        f"{topic.first / NANOSECONDS:.10g}",
        f"{topic.last / NANOSECONDS:.10g}",
        "?" if topic.gaps is None else str(topic.gaps),
        f"{topic.longest_gap:.4g}" if topic.gaps else "-",
    )


def _damage(console: Console, damage: tuple[Damage, ...]) -> None:
    for lost in damage:
        _say(console, f"damaged: {lost.size} bytes at byte {lost.offset}: {lost.what}", "red")


def info_dict(info: BagInfo) -> dict[str, Any]:
    """The same as plain data; absent numbers are None, none is NaN."""
    return {
        "path": str(info.path),
        "size": info.size,
        "messages": info.messages,
        "topics": [asdict(topic) for topic in info.topics],
        "provenance": dict(info.provenance),
        "versions": dict(info.versions),
        "end_reason": info.end_reason,
        "damage": [asdict(lost) for lost in info.damage],
        "missing": dict(info.missing),
        "by_index": info.by_index,
        "passed": info.verdict.passed,
        "verdict": info.verdict.conclusion or None,
        "remarks": [asdict(remark) for remark in info.verdict.remarks],
        "modes": [asdict(span) for span in info.verdict.spans.modes],
        "faults": [asdict(span) for span in info.verdict.spans.faults],
        "events": dict(info.verdict.events),
        "why_not": info.verdict.why_not,
        "checks": [asdict(check) for check in info.verdict.checks],
    }


def print_recovery(console: Console, done: Recovery) -> None:
    """Print what was kept and what was lost."""
    _damage(console, done.damage)
    for topic, count in done.lost.items():
        _say(console, f"lost: {count} messages on {topic}", "red")
    if done.nameless:
        _say(console, f"lost: {done.nameless} messages of topics the file no longer names", "red")
    if done.complaint:
        _say(console, f"not a run log any more ({done.complaint}): replay it with --experiment", "yellow")
    last = f"last good stamp {done.last_stamp / NANOSECONDS:.10g} s"
    _say(console, f"recovered: {sum(done.kept.values())} messages, {last}, {done.path.parent}")
    _say(console, f"ended: {done.end_reason or 'the end is not in it'}")
    if done.whole:
        _say(console, "nothing was lost")


def recovery_dict(done: Recovery) -> dict[str, Any]:
    """The same as plain data."""
    return {
        "path": str(done.path),
        "kept": done.kept,
        "lost": done.lost,
        "nameless": done.nameless,
        "damage": [asdict(lost) for lost in done.damage],
        "last_stamp": done.last_stamp,
        "end_reason": done.end_reason,
        "complaint": done.complaint,
        "whole": done.whole,
    }


def _say(console: Console, line: str, style: str | None = None) -> None:
    console.print(line, style=style, markup=False, soft_wrap=True)
