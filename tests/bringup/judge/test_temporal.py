"""Conditions over time: judged tick by tick as a formula over the whole run; the end of a run is no proof."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from space_robot_bringup.experiment.expectations import Occurrence, OverTime, Temporal
from space_robot_bringup.judge.temporal import Within, watch_of
from space_robot_bringup.judge.window import Clock, Finding, Now
from space_robot_bringup.judge.wording import pattern
from space_robot_msgs_py.interfaces import NANOSECONDS

PERIOD = NANOSECONDS // 4


def shown(spec: Temporal, holds: Sequence[bool], events: dict[int, str] | None = None, planned: int = 0) -> Finding:
    """What a run of so many ticks shows of a condition that holds at some of them."""
    clock = Clock(PERIOD, (planned or len(holds) - 1) * PERIOD)
    watch = watch_of(spec, clock)
    for tick, now in enumerate(holds):
        happened = frozenset({events[tick]} if events and tick in events else ())
        watch.step(Now(tick * PERIOD, now, float(now), happened, f"{float(now):g} rad/s"))
    return watch.finish()


def at(*ticks: int, of: int) -> list[bool]:
    """A condition that holds at these ticks."""
    return [tick in ticks for tick in range(of)]


CASES: dict[str, tuple[Temporal, list[bool], dict[int, str], int, bool | None, str]] = {
    "never, and it never does": (OverTime(never_above=1.0), at(of=9), {}, 8, True, "at worst 0 rad/s at 0 s (tick 0)"),
    "never, and it does once": (OverTime(never_above=1.0), at(5, of=9), {}, 8, False, "1 rad/s at 1.25 s (tick 5)"),
    "never, seen too short": (OverTime(never_above=1.0), at(of=9), {}, 20, None, "ended at 2 s, before 5 s"),
    "never, seen too short but it does": (OverTime(never_above=1.0), at(5, of=9), {}, 20, False, "tick 5"),
    "never for 0.5 s, and it does": (
        OverTime.model_validate({"never_above": 1.0, "for": 0.5}),
        at(2, 3, 4, of=9),
        {},
        8,
        False,
        "1 rad/s at 1 s (tick 4), since 0.5 s",
    ),
    "never for 0.5 s, and it is shorter": (
        OverTime.model_validate({"never_above": 1.0, "for": 0.5}),
        at(2, 3, 5, 6, of=9),
        {},
        8,
        True,
        "",
    ),
    "never for 0.5 s, and it may just have begun": (
        OverTime.model_validate({"never_above": 1.0, "for": 0.5}),
        at(7, 8, of=9),
        {},
        8,
        None,
        "holds since 1.75 s, and the run ends before",
    ),
    "never until a time": (OverTime(never_above=1.0, until=1.25), at(5, of=9), {}, 8, True, ""),
    "never until a time behind the run": (OverTime(never_above=1.0, until=9.0), at(of=9), {}, 8, None, "before 9 s"),
    "never from an event to another": (
        OverTime(never_above=1.0, after="a", until="b"),
        at(1, 6, of=9),
        {2: "a", 6: "b"},
        8,
        True,
        "",
    ),
    "never after what did not happen": (
        OverTime(never_above=1.0, after="a"),
        at(of=9),
        {},
        8,
        None,
        "a did not happen",
    ),
    "within of an event": (Occurrence(within=0.5, after="a"), at(5, of=9), {3: "a"}, 8, True, "after 0.5 s"),
    "within, too late": (
        Occurrence(within=0.5, after="a"),
        at(6, of=9),
        {3: "a"},
        8,
        False,
        "0 rad/s at 1.25 s (tick 5), 0.5 s after 0.75 s",
    ),
    "within, the second time too late": (
        Occurrence(within=0.5, after="a"),
        at(1, of=9),
        {1: "a", 4: "a"},
        8,
        False,
        "0.5 s after 1 s",
    ),
    "within, and the run ends before": (
        Occurrence(within=2.0, after="a"),
        at(of=9),
        {3: "a"},
        8,
        None,
        "the run ended at 2 s, too soon after 0.75 s",
    ),
    "within, held for a while": (
        Occurrence.model_validate({"within": 0.5, "for": 0.5}),
        at(0, 2, 3, 4, of=9),
        {},
        8,
        True,
        "after 0.5 s",
    ),
    "within, not held": (
        Occurrence.model_validate({"within": 0.5, "for": 0.5}),
        at(0, 2, 3, of=9),
        {},
        8,
        False,
        "tick 4",
    ),
    "at most twice, and it is three times": (
        Occurrence(at_most=2),
        at(0, 1, 3, 5, of=9),
        {},
        8,
        False,
        "3 times, last at 1.25 s (tick 5)",
    ),
    "at most twice, seen too short": (Occurrence(at_most=2), at(0, 1, of=9), {}, 20, None, "once"),
    "at least once, seen too short but it is": (Occurrence(at_least=1), at(4, of=9), {}, 20, True, "once"),
    "at least once, and it is not": (Occurrence(at_least=1), at(of=9), {}, 8, False, "0 times"),
    "at the end": (Occurrence(at_end=True), at(8, of=9), {}, 8, True, "since 2 s"),
    "at the end, and it is not any more": (
        Occurrence(at_end=True),
        at(3, of=9),
        {},
        8,
        False,
        "0 rad/s at 2 s (tick 8)",
    ),
    "at the end of a run that ended early": (Occurrence(at_end=True), at(8, of=9), {}, 9, None, "before its end"),
    "at the end for a while": (
        Occurrence.model_validate({"at_end": True, "for": 0.5}),
        at(7, 8, of=9),
        {},
        8,
        False,
        "since 1.75 s",
    ),
}


@pytest.mark.parametrize("ticks", [0, 1])
def test_a_run_of_which_nothing_was_seen_tells_nothing(ticks: int) -> None:
    """Whatever is expected: no tick, or the first one alone, is no proof of what has to hold to the end."""
    for spec in (
        OverTime(never_above=1.0),
        Occurrence(at_most=1),
        Occurrence(at_end=True),
        Occurrence(within=1.0),
        Occurrence(within=1.0, after=1.0),
        Occurrence(within=1.0, after="a"),
    ):
        found = shown(spec, [False] * ticks, planned=8)
        assert (found.passed, found.reason != "") == (None, True), spec


def judged(spec: Temporal, values: Sequence[float], *, highest: bool = True) -> Finding:
    """What a number shows of a condition: beyond 1, or below it where the smallest is the one to report."""
    watch = watch_of(spec, Clock(PERIOD, (len(values) - 1) * PERIOD), highest=highest)
    for tick, value in enumerate(values):
        holds = value > 1.0 if highest else value < 1.0
        happened = frozenset({"a"} if tick == 1 else ())
        watch.step(Now(tick * PERIOD, holds, value, happened, f"{value:g} m"))
    return watch.finish()


def test_the_number_it_depends_on_is_reported() -> None:
    """The worst of what must never be, the slowest answer, the count, the last value."""
    values = (0.5, 0.75, 3.0, 0.25, 2.0, 0.0)
    worst = "3 m at 0.5 s (tick 2)"
    assert judged(OverTime(never_above=1.0), values) == Finding(False, f"{worst}; at worst {worst}", 3.0)
    assert judged(OverTime(never_above=1.0, after=0.75, until=1.0), values) == Finding(
        True, "at worst 0.25 m at 0.75 s (tick 3)", 0.25
    )
    lowest = "0.5 m at 0 s (tick 0); at worst 0 m at 1.25 s (tick 5)"
    assert judged(OverTime(never_below=1.0), values, highest=False) == Finding(False, lowest, 0.0)
    assert judged(OverTime(above=1.0, within=0.5, after="a"), values) == Finding(True, "after 0.25 s", 0.25)
    late = "0.75 m at 0.25 s (tick 1), 0 s after 0.25 s"
    assert judged(OverTime(above=1.0, within=0.0, after="a"), values) == Finding(False, late, 0.75)
    assert judged(OverTime(above=1.0, at_most=2), values) == Finding(True, "2 times, last at 1 s (tick 4)", 2.0)
    assert judged(OverTime(above=1.0, at_most=1), values) == Finding(False, "2 times, last at 1 s (tick 4)", 2.0)
    assert judged(OverTime(above=1.0, at_least=3), values) == Finding(False, "2 times, last at 1 s (tick 4)", 2.0)
    assert judged(OverTime(above=1.0, at_least=1, until=1.0), values) == Finding(
        True, "once, last at 0.5 s (tick 2)", 1.0
    )
    assert judged(OverTime(above=1.0, at_end=True), values) == Finding(False, "0 m at 1.25 s (tick 5)", 0.0)
    always = Finding(True, "3 m at 0.25 s (tick 1), since 0 s", 3.0)
    assert judged(OverTime.model_validate({"above": 1.0, "at_end": True, "for": 0.25}), (2.0, 3.0)) == always
    assert shown(Occurrence(at_end=True), [True], planned=8) == Finding(None, "the run ended before its end")
    assert judged(OverTime(above=1.0, at_end=True), values[:-1]) == Finding(True, "2 m at 1 s (tick 4), since 1 s", 2.0)


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"never": True}, "never"),
        ({"always": True}, "always"),
        ({"never": True, "for": 0.5, "after": 2.0, "until": "a b"}, "never for 0.5 s after 2 s until a b"),
        ({"within": 5.0}, "within 5 s after the start"),
        ({"within": 5.0, "after": "jet", "for": 1.0}, "within 5 s after jet for 1 s"),
        ({"at_most": 1}, "at most once"),
        ({"at_least": 2, "at_most": 3, "after": "jet"}, "at least 2 times and at most 3 times after jet"),
        ({"at_least": 1, "for": 2.0, "until": 9.0}, "at least once for 2 s until 9 s"),
        ({"at_end": True, "for": 3.0}, "at the end for 3 s"),
    ],
)
def test_what_is_wanted_is_said_in_words(said: dict[str, Any], words: str) -> None:
    """Every pattern with its times, events and durations."""
    assert pattern(Occurrence.model_validate(said)) == words


@pytest.mark.parametrize("case", CASES)
def test_what_a_run_shows_of_a_condition(case: str) -> None:
    """Known runs: holds, fails or not judged, with a reason that names time and value."""
    spec, holds, events, last, passed, reason = CASES[case]
    found = shown(spec, holds, events, last)
    assert found.passed is passed, found
    assert reason in found.reason, found


@pytest.mark.parametrize("seed", range(40))
def test_streaming_equals_the_formula_over_the_whole_run(seed: int) -> None:
    """Of random runs: within and never, with durations and repeated events, tick by tick as over all ticks at once."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(5, 80))
    holds = (rng.random(count) < rng.choice([0.1, 0.5, 0.9])).tolist()
    events = {int(tick): "a" for tick in rng.choice(count, int(rng.integers(1, 4)))}
    span, lasting = int(rng.integers(0, 12)), int(rng.integers(1, 6))
    seconds = {"within": span / 4, "for": lasting / 4, "after": "a"}
    found = shown(Occurrence.model_validate(seconds), holds, events)
    assert found.passed is within_formula(holds, sorted(events), span, lasting), (holds, events, span, lasting)
    never = shown(OverTime.model_validate({"never_above": 0.5, "for": lasting / 4}), holds)
    runs = [all(holds[tick : tick + lasting + 1]) for tick in range(count - lasting)]
    tail = any(all(holds[tick:]) for tick in range(max(0, count - lasting), count))
    assert never.passed is (False if any(runs) else None if tail else True)


@pytest.mark.parametrize("seed", range(40))
def test_stretches_are_counted_as_in_the_whole_run(seed: int) -> None:
    """Of random runs: stretches that last long enough, in a window or not; one that may still last tells nothing."""
    rng = np.random.default_rng(seed)
    count, lasting, most = int(rng.integers(5, 60)), int(rng.integers(0, 4)), int(rng.integers(0, 6))
    holds = (rng.random(count) < rng.choice([0.2, 0.5, 0.8])).tolist()
    until = int(rng.integers(1, count)) if seed % 2 else count
    stretches = [len(part) for part in "".join("x" if hold else " " for hold in holds[:until]).split()]
    expected = sum(length > lasting for length in stretches)
    # At the end of the run, but not of a window that ends before it, a short stretch may become a long one.
    growing = until == count and holds[-1] and stretches[-1] <= lasting
    window = {"until": until / 4} if until < count else {}
    window |= {"for": lasting / 4} if lasting else {}
    at_most = shown(Occurrence.model_validate({"at_most": most} | window), holds)
    assert at_most.passed is (False if expected > most else None if growing else True), (holds, lasting, until, most)
    assert ("it holds since" in at_most.reason) is (growing and expected <= most)
    assert at_most.measured == (None if growing and expected <= most else expected)
    at_least = shown(Occurrence.model_validate({"at_least": most + 1} | window), holds)
    assert (at_least.passed, at_least.measured) == (expected > most, expected)


def test_a_window_that_never_began_says_what_it_waited_for() -> None:
    """A time behind the run, an event that did not happen, or the start of a run without a tick."""
    for spec, reason in (
        (OverTime(never_above=1.0, after=5.0), "the run ended before 5 s"),
        (OverTime(never_above=1.0, after="a"), "a did not happen"),
    ):
        assert shown(spec, [False] * 9) == Finding(None, reason)
    assert shown(OverTime(never_above=1.0), [], planned=8) == Finding(None, "the run ended before 0 s")
    assert shown(Occurrence(at_most=1), [], planned=8) == Finding(None, "the run ended before 0 s; 0 times", 0.0)


def within_formula(holds: list[bool], begun: list[int], span: int, lasting: int) -> bool | None:
    """For each beginning there is a tick soon enough from which on it holds for long enough; None: not all is seen."""
    answers = []
    for first in begun:
        starts = range(first, first + span + 1)
        seen = [holds[start : start + lasting + 1] for start in starts]
        if any(len(part) == lasting + 1 and all(part) for part in seen):
            answers.append(True)
        else:
            answers.append(None if any(len(part) <= lasting and all(part) for part in seen) else False)
    return False if False in answers else None if None in answers else True


def test_a_run_of_any_length_is_judged_in_bounded_memory() -> None:
    """An event at every tick keeps no more waiting than fit into the time an answer may take."""
    watch = Within(Occurrence.model_validate({"within": 1.0, "for": 2.0, "after": "a"}), Clock(PERIOD, 10**15))
    for tick in range(5_000):
        watch.step(Now(tick * PERIOD, tick % 3 > 0, None, frozenset({"a"}), ""))
        assert len(watch._waiting) <= 1 + math.ceil(3.0 * NANOSECONDS / PERIOD)
