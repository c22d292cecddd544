"""The readings of a claim: every combination of the choices it hangs on, and the verdict they come to together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from typing import Any

from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.reproduce.manifest import VERDICTS, Choice, Claim

HOLDS, FAILS, CLOSE, NOT_CHECKABLE, STUDY = VERDICTS
UNDECIDED = "undecided"
DEPENDS = "depends on"
MAX_READINGS = 64


@dataclass(frozen=True, slots=True)
class Reading:
    """One value for each choice that a claim hangs on.

    Attributes:
        values: choice -> name of its value.
        choices: the choices.
    """

    values: Mapping[str, str]
    choices: Mapping[str, Choice]

    @property
    def label(self) -> str:
        """The values in words; empty where nothing is open."""
        return ", ".join(f"{choice}: {value}" for choice, value in self.values.items())

    @property
    def let(self) -> dict[str, str]:
        """Names and formulas that this reading gives to the condition."""
        chosen = (self.choices[name].values[value] for name, value in self.values.items())
        return {name: str(formula) for value in chosen for name, formula in value.let.items()}

    def changing(self, group: str) -> dict[str, str]:
        """Choice -> value of those that set something of the runs of a group."""
        return {
            name: value
            for name, value in self.values.items()
            if self.choices[name].values[value].set and group in (self.choices[name].of or (group,))
        }

    def overrides(self, group: str) -> dict[str, Any]:
        """What this reading sets of the runs of a group."""
        changed: dict[str, Any] = {}
        for name, value in self.changing(group).items():
            changed |= self.choices[name].values[value].set
        return changed


def readings_of(claim: Claim, choices: Mapping[str, Choice], key: str) -> tuple[Reading, ...]:
    """Every reading of a claim, that of the figures first; one without values where nothing is open.

    Raises:
        SpecError: there is no such choice, it changes nothing here, or the readings are too many.
    """
    groups = {group for measure in claim.measures.values() for group in measure.all_groups}
    for name in claim.hangs_on:
        if name not in choices:
            accepted = nearest(name, choices) or ", ".join(choices) or "none is there"
            raise SpecError("no such choice", key=f"{key}.hangs_on", value=name, accepted=accepted)
        one = choices[name]
        if one.of is not None and not groups & set(one.of):
            raise SpecError("changes no group of this claim", key=f"{key}.hangs_on", value=name, accepted=str(one.of))
    mine = {name: choices[name] for name in claim.hangs_on}
    found = [
        Reading(dict(zip(mine, values, strict=True)), mine) for values in product(*(c.values for c in mine.values()))
    ]
    if len(found) > MAX_READINGS:
        raise SpecError("too many readings", key=f"{key}.hangs_on", value=len(found), accepted=f"<= {MAX_READINGS}")
    return tuple(found)


def combined(verdicts: Sequence[tuple[Mapping[str, str], str]]) -> str:
    """The verdict over all readings.

    Args:
        verdicts: of each reading its values, by choice, and its own verdict.
    """
    found = {verdict for _, verdict in verdicts}
    if len(found) == 1:
        return found.pop()
    if UNDECIDED in found:
        return UNDECIDED
    if not {HOLDS, FAILS} <= found:
        return CLOSE
    return f"{DEPENDS} {', '.join(deciding(verdicts))}"


def deciding(verdicts: Sequence[tuple[Mapping[str, str], str]]) -> list[str]:
    """The choices of which one alone turns a verdict; if none does alone, the fewest that differ between such readings.

    Args:
        verdicts: as of ``combined``; what turns it is from holding to not, or where nothing does, to too close.

    Returns:
        Names, in order; none where all readings agree.
    """
    pairs = list(combinations(verdicts, 2))
    turned = [(a, b) for (a, one), (b, other) in pairs if {one, other} == {HOLDS, FAILS}]
    turned = turned or [(a, b) for (a, one), (b, other) in pairs if one != other]
    differing = [[name for name in a if a[name] != b[name]] for a, b in turned]
    fewest = min(map(len, differing), default=0)
    chosen = {name for names in differing if len(names) == fewest for name in names}
    return [name for name in verdicts[0][0] if name in chosen]
