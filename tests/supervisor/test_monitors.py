"""One row of a supervision table against its definition over the whole run, with any settings and values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from space_robot_supervisor.monitors import Monitor
from space_robot_supervisor.rows import MonitorSpec
from tests.support.supervised import reported, supervisor, watched

# Around both thresholds and both of them less or more the hysteresis, and on each of these.
RATES = (-1.5, -1.0, -0.75, -0.5, 0.0, 0.5, 0.75, 1.0, 1.5)


def random_row(rng: np.random.Generator) -> dict[str, Any]:
    """Some row that reads a rate."""
    bounds = [{"above": 1.0}, {"below": -1.0}, {"above": 1.0, "below": -1.0}, {"unchanged": True}][rng.integers(4)]
    row: dict[str, Any] = {"name": "row", "value": "rate.z", "for": int(rng.integers(1, 4))} | bounds
    row["inhibit_after"] = int(rng.choice([0, 0, 1, 3]))
    if "unchanged" not in row:
        row["hysteresis"] = float(rng.choice([0.0, 0.25, 0.5]))
    if rng.random() < 0.3:
        row["times"] = int(rng.integers(1, 3))
    return row


def by_definition(spec: MonitorSpec, values: Sequence[float | None]) -> list[tuple[int, str]]:
    """It fires at the last of so many ticks in a row, is not looked at for a while, clears, and begins again."""

    def holds(tick: int, slack: float) -> bool:
        value = values[tick]
        if value is None:
            return False
        if spec.unchanged:
            return tick > 0 and value == values[tick - 1]
        above = spec.above is not None and value > spec.above - slack
        return above or (spec.below is not None and value < spec.below + slack)

    found: list[tuple[int, str]] = []
    begin, count = 0, len(values)
    while spec.times is None or len(found) < 2 * spec.times:
        ends = range(begin + spec.for_ - 1, count)
        fires = next((k for k in ends if all(holds(j, 0.0) for j in range(k - spec.for_ + 1, k + 1))), None)
        if fires is None:
            break
        found.append((fires, "fires"))
        looked = range(fires + 1 + spec.inhibit_after, count)
        clears = next((k for k in looked if not holds(k, spec.hysteresis)), None)
        if clears is None:
            break
        found.append((clears, "clears"))
        begin = clears + 1
    return found


@pytest.mark.parametrize("seed", range(60))
def test_a_row_fires_and_clears_by_its_definition(seed: int) -> None:
    """Persistence, hysteresis, inhibition and number of times, in any combination, tick by tick."""
    rng = np.random.default_rng(seed)
    row, rates = random_row(rng), rng.choice(RATES, 60).tolist()
    found = reported(watched(supervisor(row, modes={"NOMINAL": {}}), rates), "row")
    assert found == by_definition(MonitorSpec.model_validate(row), rates), row


@pytest.mark.parametrize("seed", range(30))
def test_a_value_that_is_not_there_holds_nothing(seed: int) -> None:
    """A number that is missing for a tick breaks what has to hold in a row, ends it, and equals no other one."""
    rng = np.random.default_rng(seed)
    spec = MonitorSpec.model_validate(random_row(rng))
    values = [None if rng.random() < 0.2 else float(rate) for rate in rng.choice(RATES, 60)]
    monitor = Monitor(spec)
    for _ in range(2):
        pairs = enumerate(zip([None, *values], values, strict=False))
        edges = [(tick, edge) for tick, (before, value) in pairs if (edge := monitor.look(before, value)) is not None]
        assert edges == by_definition(spec, values)
        monitor.reset()


def test_a_mode_that_is_entered_again_counts_from_zero_but_not_the_times() -> None:
    """What held before is forgotten; how long it is still not looked at, and how often it may fire, is not."""
    spec = MonitorSpec.model_validate(
        {"name": "a", "value": "b", "above": 1.0, "for": 2, "times": 2, "inhibit_after": 1}
    )
    monitor = Monitor(spec)
    assert [monitor.look(None, value) for value in (2.0, 2.0)] == [None, "fires"]
    monitor.enter()
    assert [monitor.look(None, value) for value in (2.0, 2.0, 2.0)] == [None, None, "fires"]
    monitor.enter()
    assert [monitor.look(None, value) for value in (2.0,) * 5] == [None] * 5
