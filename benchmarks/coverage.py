"""What becomes of a robot with a fault: every kind x five laws x without and with supervision, as a table in Markdown.

python -m benchmarks.coverage DIRECTORY [RUNS [KIND ...]] [--robot servicer] [--workers N]

Runs what is not in the directory yet, so that it may be interrupted at any time and goes on. Of each run:
survives (follows its reference again), degrades (at rest, within 0.35 rad), safe (at rest elsewhere) or lost (still
moving at the end, beyond a joint limit, or ended early); a cell has the worst of its draws, and how many were so.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from space_robot_studies.campaign.campaign import run_campaign
from space_robot_studies.campaign.directory import campaign_rows
from space_robot_studies.campaign.spec import Campaign, load_campaign
from space_robot_studies.engine.hooks import StudyHooks

ROBOTS = ("mini", "servicer")
OUTCOMES = ("survives", "degrades", "safe", "lost")
MOVING = ("base.rate", "joints.rate", "joints.beyond")
ERRORS = ("error.attitude", "error.joints")
Columns = Mapping[str, Any]


def outcome(row: Columns) -> str:
    """What became of a run, from its row.

    Args:
        row: its ``failed`` names what it missed: an error once where it is beyond the closer of its two bounds, twice
            where it is beyond both.
    """
    missed = row["failed"].split(", ")
    if not row["completed"] or any(name in missed for name in MOVING):
        return "lost"
    return OUTCOMES[max(missed.count(name) for name in ERRORS)]


def cell(rows: Sequence[Columns]) -> str:
    """The worst outcome of some draws, and of how many."""
    found = [outcome(row) for row in rows]
    worst = max(found, key=OUTCOMES.index)
    return worst if found.count(worst) == len(found) else f"{worst} {found.count(worst)}/{len(found)}"


def why(row: Columns) -> str:
    """Why a run is lost: what of it was not as it should be."""
    if not row["completed"]:
        return "ended early"
    reasons = {
        "joints.beyond": "a joint beyond its limit",
        "base.rate": "the base moves",
        "joints.rate": "the arm moves",
    }
    missed = row["failed"].split(", ")
    return ", ".join(text for name, text in reasons.items() if name in missed)


def summary(rows: Sequence[Columns]) -> str:
    """How many runs had which outcome, without → with supervision, and each cell that is lost with it, with reasons."""
    counts = {how: Counter(outcome(row) for row in rows if row["supervision"] == how) for how in ("without", "with")}
    total = sum(counts["without"].values())
    said = ", ".join(f"{counts['without'][name]} → {counts['with'][name]} {name}" for name in OUTCOMES)
    lost: dict[str, Counter[str]] = {}
    for row in rows:
        if row["supervision"] == "with" and outcome(row) == "lost":
            lost.setdefault(f"`{row['faults']}` with `{row['controller']}`", Counter())[why(row)] += 1
    lines = [f"- {place}: {', '.join(f'{text} ({n})' for text, n in found.items())}" for place, found in lost.items()]
    head = f"Of {total} runs each, without → with supervision: {said}. Lost with supervision:"
    return "\n".join([head, "", *(lines or ["- none"])])


def table(rows: Iterable[Columns]) -> str:
    """A row per kind of fault, a column per law, each without | with supervision."""
    cells: dict[str, dict[tuple[str, str], list[Columns]]] = {}
    for row in rows:
        where = (row["controller"], row["supervision"])
        cells.setdefault(row["faults"], {}).setdefault(where, []).append(row)
    laws = list(dict.fromkeys(law for found in cells.values() for law, _ in found))
    lines = [f"| fault | {' | '.join(laws)} |", f"|---|{'---|' * len(laws)}"]
    for kind, found in cells.items():
        pairs = (" → ".join(cell(found[law, how]) for how in ("without", "with")) for law in laws)
        lines.append(f"| `{kind}` | {' | '.join(pairs)} |")
    return "\n".join(lines)


def chosen(runs: int, kinds: Sequence[str], robot: str = "mini") -> Campaign:
    """The campaign of a robot with so many draws, of these kinds of faults; none: of all."""
    campaign = load_campaign(Path(__file__).with_name(f"coverage_{robot}.yaml"), runs)
    faults = campaign.vary["faults"]
    assert isinstance(faults, Mapping)
    kept = {kind: faults[kind] for kind in kinds or faults}
    return campaign.model_copy(update={"vary": {**campaign.vary, "faults": kept}})


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is missing and print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.coverage")
    parser.add_argument("directory", type=Path)
    parser.add_argument("runs", type=int, nargs="?", default=20, help="draws of each cell")
    parser.add_argument("kinds", nargs="*", help="of faults; default: all")
    parser.add_argument("--robot", choices=ROBOTS, default="mini")
    parser.add_argument("--workers", type=int, default=None, help="default: one per core")
    given = parser.parse_args(arguments)
    directory, campaign = given.directory, chosen(given.runs, given.kinds, given.robot)
    hooks = StudyHooks(on_row=lambda done: print(f"\r{done} of {campaign.cases}", end="", file=sys.stderr))
    result = run_campaign(campaign, directory, keep="none", resume=True, hooks=hooks, workers=given.workers)
    print(file=sys.stderr)
    if result.end_reason != "completed":
        return 1
    rows = campaign_rows(directory)[1]
    found = [rows[index].columns for index in sorted(rows)]
    print(table(found), summary(found), sep="\n\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
