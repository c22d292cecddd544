"""Claims against what was measured: the measures, the condition, the verdict in every reading."""

from __future__ import annotations

import string
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from keyword import iskeyword

from space_robot_msgs_py.errors import SpecError
from space_robot_studies.reproduce.estimate import exact
from space_robot_studies.reproduce.expression import FUNCTIONS, Condition, Formula
from space_robot_studies.reproduce.manifest import Bounds, Claim, Figure
from space_robot_studies.reproduce.measures import FinishedRun, Measured, divisors, paired, reduce, selected
from space_robot_studies.reproduce.planner import PlannedRun, ReadingRuns
from space_robot_studies.reproduce.readings import (
    CLOSE,
    FAILS,
    HOLDS,
    NOT_CHECKABLE,
    STUDY,
    UNDECIDED,
    Reading,
    combined,
    deciding,
)
from space_robot_studies.reproduce.run_data import RunData

# What ``found`` may name beside the measures: number of runs, and their seeds.
EXTRA = ("n", "seeds")


@dataclass(frozen=True, slots=True)
class ReadingJudgement:
    """What a claim came to in one reading.

    Attributes:
        reading: what was chosen.
        verdict: holds, does not hold, too close, study or undecided.
        found: what was measured, in words.
        measured: by name.
        runs: how many distinct runs it is about.
        seeds: of those that are no cases of a campaign.
        draws: numbers of those that are, in it.
    """

    reading: Reading
    verdict: str
    found: str
    measured: dict[str, Measured]
    runs: int
    seeds: tuple[int, ...]
    draws: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Judgement:
    """A claim and what became of it; the verdict follows from the readings and from nothing else.

    Attributes:
        claim: the claim.
        readings: what it came to in each; none if it cannot be checked.
    """

    claim: Claim
    readings: tuple[ReadingJudgement, ...]

    @property
    def verdict(self) -> str:
        """Holds, does not hold, depends on a choice, too close, not checkable, study, or undecided."""
        if not self.readings:
            return NOT_CHECKABLE
        return combined(self._verdicts)

    @property
    def deciding(self) -> list[str]:
        """The choices that turn the verdict."""
        return deciding(self._verdicts)

    @property
    def _verdicts(self) -> list[tuple[Mapping[str, str], str]]:
        return [(one.reading.values, one.verdict) for one in self.readings]

    @property
    def changed(self) -> bool:
        """The verdict is not the expected one, or there is none."""
        verdict = self.verdict
        return verdict == UNDECIDED or (bool(self.claim.expect) and verdict != self.claim.expect)


def check_words(claim: Claim, let: Mapping[str, str], key: str) -> None:
    """Refuse a condition or a text that names what there is not.

    Args:
        claim: the claim.
        let: names and formulas of one of its readings.
        key: its path.

    Raises:
        SpecError: with the key and the nearest names.
    """
    if not claim.measures:
        return
    numbers = [*claim.measures, *let, *claim.derived]
    for name in numbers:
        if not name.isidentifier() or iskeyword(name) or name in (*EXTRA, *FUNCTIONS) or numbers.count(name) > 1:
            accepted = "letters, digits and _, no word of a condition, no name of another number"
            raise SpecError("not a usable name", key=f"{key}.measures", value=name, accepted=accepted)
    for name, formula in let.items():
        Formula(formula, tuple(claim.measures), f"{key}.hangs_on, let {name}")
    for name, formula in claim.derived.items():
        Formula(formula, (*claim.measures, *let), f"{key}.derived.{name}")
    if claim.holds_if:
        Condition(claim.holds_if, numbers, f"{key}.holds_if")
    names = [*numbers, *EXTRA]
    try:
        fields = [name for _, name, _, _ in string.Formatter().parse(claim.found) if name is not None]
        if unknown := [name for name in fields if name not in names]:
            raise SpecError("no such measure", key=f"{key}.found", value=unknown[0], accepted=", ".join(names))
        claim.found.format_map({**dict.fromkeys(numbers, exact(1.0)), "n": 1, "seeds": "1-4"})
    except SpecError:
        raise
    except (ValueError, LookupError, AttributeError, TypeError) as error:
        raise SpecError(f"not a format string: {error}", key=f"{key}.found", value=claim.found) from None


def judge(
    claim: Claim, figure: Figure, readings: Sequence[ReadingRuns], finished: Callable[[PlannedRun], RunData]
) -> Judgement:
    """Measure a claim on finished runs and decide it, reading by reading.

    Args:
        claim: of the figure.
        figure: whose bounds say what has diverged.
        readings: of the claim, with their runs.
        finished: what a run has left.
    """
    if not claim.measures:
        return Judgement(claim, ())
    return Judgement(
        claim,
        tuple(
            _judge(claim, figure.diverged, one.reading, [(run, finished(run)) for run in one.runs]) for one in readings
        ),
    )


def _judge(claim: Claim, bounds: Bounds, reading: Reading, runs: Sequence[FinishedRun]) -> ReadingJudgement:
    measured: dict[str, Measured] = {}
    used: dict[str, tuple[str, int]] = {}
    for name, measure in claim.measures.items():
        chosen = paired(measure, selected(measure, runs), runs, bounds)
        measured[name] = reduce(measure, chosen, bounds, divisors(measure, runs))
        used |= {run.distinct.name: run.source for run, _ in chosen}
    seeds, draws = (tuple(sorted({n for what, n in used.values() if what == kind})) for kind in ("seed", "draw"))
    verdict, found = _decide(claim, reading.let, measured, len(used), seeds)
    return ReadingJudgement(reading, verdict, found, measured, len(used), seeds, draws)


def seed_text(seeds: Sequence[int]) -> str:
    """Sorted seeds in few characters: ``0``, ``1-4``, ``1-4, 7``."""
    pieces: list[list[int]] = []
    for seed in seeds:
        if pieces and seed == pieces[-1][1] + 1:
            pieces[-1][1] = seed
        else:
            pieces.append([seed, seed])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in pieces)


def _decide(
    claim: Claim, let: Mapping[str, str], measured: Mapping[str, Measured], runs: int, seeds: Sequence[int]
) -> tuple[str, str]:
    for name, one in measured.items():
        if one.estimate is None:
            return UNDECIDED, f"{name}: {one.why}"
    values = {name: one.estimate for name, one in measured.items() if one.estimate is not None}
    try:
        for formulas in (let, claim.derived):
            values |= {name: Formula(text, tuple(values), name).estimate(values) for name, text in formulas.items()}
    except ArithmeticError as error:
        return UNDECIDED, f"derived: {error}"
    found = claim.found.format_map({**values, "n": runs, "seeds": seed_text(seeds)})
    if not claim.holds_if:
        return STUDY, found
    try:
        holds = Condition(claim.holds_if, tuple(values), "holds_if").holds(values)
    except ArithmeticError as error:
        return UNDECIDED, f"{found} ({claim.holds_if}: {error})"
    return {True: HOLDS, False: FAILS, None: CLOSE}[holds], found
