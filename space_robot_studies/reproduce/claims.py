"""Claims against what was measured: the measures, the condition, the verdict."""

from __future__ import annotations

import string
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from keyword import iskeyword

from space_robot_msgs_py.errors import SpecError
from space_robot_studies.reproduce.expression import FUNCTIONS, Condition, Formula
from space_robot_studies.reproduce.manifest import Claim, Figure
from space_robot_studies.reproduce.measures import FinishedRun, Measured, paired, reduce, select

UNDECIDED = "undecided"
# What ``found`` may name beside the measures: number of runs, and their seeds.
EXTRA = ("n", "seeds")


@dataclass(frozen=True, slots=True)
class Judgement:
    """A claim and what became of it.

    Attributes:
        claim: the claim.
        verdict: holds, does not hold, not checkable, or undecided.
        found: what was measured, in words.
        measured: by name.
        runs: how many distinct runs it is about.
        seeds: of those that are no cases of a campaign.
        draws: numbers of those that are, in it.
    """

    claim: Claim
    verdict: str
    found: str
    measured: dict[str, Measured]
    runs: int
    seeds: tuple[int, ...]
    draws: tuple[int, ...] = ()

    @property
    def changed(self) -> bool:
        """The verdict is not the documented one."""
        return self.verdict != self.claim.verdict


def check_words(claim: Claim, key: str) -> None:
    """Refuse a condition or a text that names what there is not.

    Raises:
        SpecError: with the key and the nearest names.
    """
    if not claim.measures:
        return
    numbers = [*claim.measures, *claim.derived]
    for name in numbers:
        if not name.isidentifier() or iskeyword(name) or name in (*EXTRA, *FUNCTIONS) or numbers.count(name) > 1:
            accepted = "letters, digits and _, no word of a condition, no name of another number"
            raise SpecError("not a usable name", key=f"{key}.measures", value=name, accepted=accepted)
    for name, formula in claim.derived.items():
        Formula(formula, tuple(claim.measures), f"{key}.derived.{name}")
    Condition(claim.holds_if, numbers, f"{key}.holds_if")
    names = [*numbers, *EXTRA]
    try:
        fields = [name for _, name, _, _ in string.Formatter().parse(claim.found) if name is not None]
        if unknown := [name for name in fields if name not in names]:
            raise SpecError("no such measure", key=f"{key}.found", value=unknown[0], accepted=", ".join(names))
        claim.found.format_map({**dict.fromkeys(numbers, 1.0), "n": 1, "seeds": "1-4"})
    except SpecError:
        raise
    except (ValueError, LookupError, AttributeError, TypeError) as error:
        raise SpecError(f"not a format string: {error}", key=f"{key}.found", value=claim.found) from None


def judge(claim: Claim, figure: Figure, runs: Sequence[FinishedRun]) -> Judgement:
    """Measure a claim on the finished runs of its figure and decide it."""
    if claim.verdict == "not checkable":
        return Judgement(claim, claim.verdict, "", {}, 0, ())
    measured: dict[str, Measured] = {}
    used: dict[str, tuple[str, int]] = {}
    finished = {run.label: (run, data) for run, data in runs}
    for name, measure in claim.measures.items():
        chosen = [finished[run.label] for run in select(measure, [run for run, _ in runs])]
        chosen = paired(measure, chosen, runs, figure.diverged)
        measured[name] = reduce(measure, chosen, figure.diverged)
        used |= {run.distinct.name: run.source for run, _ in chosen}
    seeds, draws = (tuple(sorted({n for what, n in used.values() if what == kind})) for kind in ("seed", "draw"))
    verdict, found = _decide(claim, measured, len(used), seeds)
    return Judgement(claim, verdict, found, measured, len(used), seeds, draws)


def seed_text(seeds: Sequence[int]) -> str:
    """Sorted seeds in few characters: ``0``, ``1-4``, ``1-4, 7``."""
    pieces: list[list[int]] = []
    for seed in seeds:
        if pieces and seed == pieces[-1][1] + 1:
            pieces[-1][1] = seed
        else:
            pieces.append([seed, seed])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in pieces)


def _decide(claim: Claim, measured: Mapping[str, Measured], runs: int, seeds: Sequence[int]) -> tuple[str, str]:
    for name, one in measured.items():
        if one.value is None:
            return UNDECIDED, f"{name}: {one.why}"
    values = {name: one.value for name, one in measured.items() if one.value is not None}
    try:
        values |= {name: Formula(text, tuple(values), name).value(values) for name, text in claim.derived.items()}
    except ArithmeticError as error:
        return UNDECIDED, f"derived: {error}"
    found = claim.found.format_map({**values, "n": runs, "seeds": seed_text(seeds)})
    try:
        holds = Condition(claim.holds_if, tuple(values), "holds_if").holds(values)
    except ArithmeticError as error:
        return UNDECIDED, f"{found} ({claim.holds_if}: {error})"
    return ("holds" if holds else "does not hold"), found
