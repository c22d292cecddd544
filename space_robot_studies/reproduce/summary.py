"""A reproduction as plain data: what the page shows and ``claims.json`` holds."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from space_robot_bringup.compose.versions import versions
from space_robot_studies.engine.journal import RUNS
from space_robot_studies.reproduce.claims import Judgement, ReadingJudgement, seed_text
from space_robot_studies.reproduce.manifest import Choice, Claim, Figure, Table
from space_robot_studies.reproduce.measures import FinishedRun, Measured, reduce
from space_robot_studies.reproduce.plan import Plan
from space_robot_studies.reproduce.planner import PlannedRun, run_label
from space_robot_studies.reproduce.quantities import Measure
from space_robot_studies.reproduce.readings import CLOSE, DEPENDS, FAILS, HOLDS, NOT_CHECKABLE, STUDY, UNDECIDED
from space_robot_studies.reproduce.reproduction import FigureResult, passed

Data = dict[str, Any]
# Of a verdict without the choices that it depends on.
STYLES = {
    HOLDS: "green",
    FAILS: "yellow",
    DEPENDS: "cyan",
    CLOSE: "magenta",
    NOT_CHECKABLE: "dim",
    STUDY: "dim",
    UNDECIDED: "red",
}


def summary(plan: Plan, finished: Sequence[FigureResult], pictures: dict[str, str]) -> Data:
    """Everything that was found, in numbers and words; no NaN, and of the wall clock only cycle times.

    Args:
        plan: of the paper.
        finished: its figures.
        pictures: file name by figure.
    """
    manifest = plan.manifest
    return {
        "paper": plan.name,
        "command": shlex.join(["space-robot", "reproduce", plan.argument]),
        "title": manifest.title,
        "citation": manifest.citation,
        "notes": manifest.notes,
        "passed": passed(finished),
        "runs": len({run.distinct.name for figure in finished for run, _ in (*figure.runs, *figure.read)}),
        "versions": versions(),
        "figures": [_figure(figure, pictures.get(figure.name), manifest.choices) for figure in finished],
    }


def _figure(finished: FigureResult, picture: str | None, choices: Mapping[str, Choice]) -> Data:
    failed = [run.label for run, _ in finished.failures]
    return {
        "name": finished.name,
        "title": finished.figure.title,
        "kind": finished.figure.kind,
        "caption": finished.figure.caption,
        "picture": picture,
        "claims": [_claim(judgement, choices) for judgement in finished.judgements],
        "tables": [_table(table, finished) for table in finished.figure.tables],
        "timing": {group: asdict(times) for group, times in finished.times.items()},
        "runs": [_run(pair, finished.figure) for pair in (*finished.runs, *finished.read)],
        "failed": failed,
    }


def _claim(judgement: Judgement, choices: Mapping[str, Choice]) -> Data:
    claim, verdict = judgement.claim, judgement.verdict
    return {
        "paper": claim.paper,
        "verdict": verdict,
        "kind": DEPENDS if verdict.startswith(DEPENDS) else verdict,
        "deciding": judgement.deciding if judgement.readings else [],
        "expected": claim.expect,
        "changed": judgement.changed,
        "because": claim.because,
        "condition": claim.holds_if,
        "choices": {name: _choice(choices[name]) for name in claim.hangs_on},
        "readings": [_reading(claim, one) for one in judgement.readings],
    }


def _choice(choice: Choice) -> Data:
    return {"open": choice.open, "ours": choice.ours, "values": list(choice.values)}


def _reading(claim: Claim, one: ReadingJudgement) -> Data:
    return {
        "label": one.reading.label,
        "values": dict(one.reading.values),
        "let": one.reading.let,
        "verdict": one.verdict,
        "found": one.found,
        "measures": {name: _measure(claim.measures[name], measured) for name, measured in one.measured.items()},
        "runs": one.runs,
        "seeds": seed_text(one.seeds),
        "draws": seed_text(one.draws),
    }


def _measure(measure: Measure, measured: Measured) -> Data:
    where = "".join(f", {key} = {value}" for key, value in measure.where.items())
    if (partners := measure.only_if) is not None:
        where += f", where {', '.join(partners.groups)} have {partners.quantity} at the same seed"
    over = f" over that of the same seed in {measure.over}" if measure.over else ""
    meaning = f"{measure.quantity} of {', '.join(measure.groups)}{over}{where}"
    return {
        "quantity": str(measure.quantity),
        "meaning": f"{measure.reduce}: {meaning}" if measure.reduce else meaning,
        **_estimate(measured),
        "without": list(measured.without),
        "missing": measure.missing,
        "why": measured.why,
    }


def _table(table: Table, finished: FigureResult) -> Data:
    runs = [pair for pair in finished.runs if table.of is None or pair[0].group in table.of]
    rows: dict[str, list[FinishedRun]] = {}
    for pair in runs:
        rows.setdefault(_row(table, pair[0], finished.figure), []).append(pair)
    cells = {
        row: [reduce(number, members, finished.figure.diverged) for number in table.columns.values()]
        for row, members in rows.items()
    }
    return {
        "title": table.title,
        "columns": list(table.columns),
        "digits": table.digits,
        "rows": {row: [_cell(one, table.digits) for one in found] for row, found in cells.items()},
        "runs": {row: len(members) for row, members in rows.items()},
    }


def _row(table: Table, run: PlannedRun, figure: Figure) -> str:
    """The label of the row that a run belongs to."""
    if table.rows == "runs":
        return run.label
    if table.rows == "groups":
        return run.group
    return run_label(run.group, {key: run.values[key] for key in figure.runs[run.group].vary})


def _cell(measured: Measured, digits: int) -> Data:
    text = (
        "-" if measured.estimate is None else format(measured.estimate, "" if measured.estimate.of else f".{digits}g")
    )
    return {**_estimate(measured), "without": len(measured.without), "text": text}


def _estimate(measured: Measured) -> Data:
    one = measured.estimate
    low, high = (None, None) if one is None or one.exact else (one.low, one.high)
    return {"value": measured.value, "low": low, "high": high, "runs": measured.runs}


def _run(pair: FinishedRun, figure: Figure) -> Data:
    run, data = pair
    broken = f"{', '.join(data.broken)} beyond the plant's own bound" if data.broken else ""
    return {
        "label": run.label,
        "group": run.group,
        "command": run.distinct.command,
        "seed": run.distinct.experiment.seed,
        "bag": f"{RUNS}/{run.distinct.name}" if data.bag else None,
        "end_reason": broken or data.end_reason,
        "completed": data.completed,
        "diverged": data.diverged(figure.diverged),
        "warnings": list(data.warnings),
    }


def heading(figure: Data) -> str:
    """What a figure is called: ``Figure 8``, ``Figures 6-9``, ``Table 2`` for 8, 6-9, table2, else its own name."""
    name = figure["name"]
    if name.isdecimal():
        name = f"Figure {name}"
    elif re.fullmatch(r"\d+-\d+", name):
        name = f"Figures {name}"
    elif table := re.fullmatch(r"table[ -]?(\d+)", name):
        name = f"Table {table[1]}"
    beyond = " (beyond the paper)" if figure["kind"] == "beyond" else ""
    return f"{name}: {figure['title']}{beyond}"


def count(data: Data) -> str:
    """How many claims have which verdict, from how many runs."""
    claims = [claim for figure in data["figures"] for claim in figure["claims"]]
    verdicts = [claim["kind"] for claim in claims if claim["kind"] != STUDY]
    if not verdicts:
        return f"no claims, {data['runs']} runs"
    parts = [f"{verdicts.count(kind)} {_plural(kind)}" for kind in STYLES if kind in verdicts]
    return f"{len(verdicts)} claims ({', '.join(parts)}) from {data['runs']} runs"


def _plural(kind: str) -> str:
    return f"{kind} a choice" if kind == DEPENDS else kind


def sample(reading: Data) -> str:
    """How many runs a reading of a claim is about, and which seeds or draws of a campaign they have."""
    runs = "1 run" if reading["runs"] == 1 else f"{reading['runs']} runs"
    sources = [f"{kind} {reading[f'{kind}s']}" for kind in ("seed", "draw") if reading[f"{kind}s"]]
    return ", ".join([runs, *sources])
