"""How a campaign looks at its end: tables for people, one dictionary for programs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from space_robot_cli.render.run import STYLES, missed
from space_robot_cli.terminal import markup
from space_robot_studies.campaign.campaign import TABLE, CampaignResult, describe
from space_robot_studies.campaign.directory import CAMPAIGN
from space_robot_studies.campaign.statistics import Group, Rate
from space_robot_studies.engine.journal import bag_path

SHOWN_CASES = 5


def as_dict(title: str, result: CampaignResult) -> dict[str, Any]:
    """The result as plain data; no number is NaN."""
    return {
        "title": title,
        "directory": str(result.directory),
        "end_reason": result.end_reason,
        "passed": result.passed,
        "verdict": result.conclusion,
        "done": result.done,
        "total": result.total,
        "lost": result.lost,
        "wall_time": result.wall_time,
        "groups": [group.to_dict() for group in result.groups],
        "checks": [asdict(check) for check in result.checks],
    }


def campaign(console: Console, title: str, result: CampaignResult) -> None:
    """Print the spreads, the rates, the failed cases and how to run one again."""
    for group in result.groups:
        console.print(_spreads(group))
        for line in _lines(group, result):
            console.print(line, markup=False, soft_wrap=True)
    missed(console, result.checks, ())
    ended = "" if result.passed is None else f" ({result.end_reason})"
    console.print(
        f"{result.conclusion}{ended}: {title or 'campaign'}, {result.done} of {result.total} runs, "
        f"{result.wall_time:.1f} s",
        style=STYLES[result.passed],
        markup=False,
        soft_wrap=True,
    )
    if result.groups:
        console.print(f"table: {result.directory / TABLE}", markup=False, soft_wrap=True)
    again = f"space-robot campaign {result.directory / CAMPAIGN} --out {result.directory} --resume"
    if not result.groups:
        console.print(f"finished rows are kept; go on: {again}", markup=False, soft_wrap=True)
    elif result.lost:
        console.print(f"lost with their worker: {result.lost}; run them again: {again}", markup=False, soft_wrap=True)


def _spreads(group: Group) -> Table:
    title = markup(describe(group.labels)) or None
    table = Table(box=SIMPLE_HEAD, title=title, title_justify="left")
    table.add_column("metric", no_wrap=True)
    for heading in ("n", "missing", "mean, 95 % interval", "p05", "median", "p95", "max", "worst case"):
        table.add_column(heading.replace(", ", ",\n").replace(" case", "\ncase"), justify="right")
    for name, s in group.spreads.items():
        worst = "-" if s.worst is None else str(s.worst)
        mean = f"{_short(s.mean)} \\[{_short(s.mean_low)}, {_short(s.mean_high)}]"
        numbers = (_short(value) for value in (s.p05, s.median, s.p95, s.max))
        table.add_row(markup(name), str(s.n), str(s.missing), mean, *numbers, worst)
    return table


def _lines(group: Group, result: CampaignResult) -> Iterator[str]:
    yield f"kept every bound: {_rate(group.success)}"
    if group.undecided:
        yield f"  nothing was expected of {'any' if group.undecided == group.success.n else group.undecided} of them"
    yield f"completed: {_rate(group.completed)}"
    for reason, count in group.reasons.items():
        yield f"  {count} x {reason}"
    for remark, count in group.remarks.items():
        yield f"remark: {count} x {remark}"
    shown, rest = group.failed[:SHOWN_CASES], len(group.failed) - SHOWN_CASES
    for index in shown:
        bag = bag_path(result.directory, index)
        kept = f", bag {bag}" if bag.exists() else ""
        yield f"  case {index} failed: space-robot run --from {result.directory} --index {index}{kept}"
    if rest > 0:
        yield f"  and {rest} more failed"


def _rate(rate: Rate) -> str:
    interval = f"{100 * rate.low:.1f} to {100 * rate.high:.1f} %"
    return f"{rate.count} of {rate.n} = {100 * rate.rate:.1f} %, 95 % interval {interval} (Wilson)"


def _short(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.3g}" if value == 0.0 or abs(value) >= 1e-3 else f"{value:.0e}"
