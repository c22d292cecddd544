"""Did the run do what it should: bounds that hold for every run, and those the experiment states."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from space_robot_bringup.experiment.expectations import Expectation
from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.metrics import PER_AXIS, RunMetrics
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS

if TYPE_CHECKING:
    from space_robot_msgs_py.log.arrays import Stamps

# A plant that loses more than this is wrong, whatever the controller does. The residuals bound no trajectory: fixed
# steps keep momentum to 1e-8 where joints are 1e-3 rad off. The error of the integration does, where it is estimated.
INTEGRATION_ERROR = "integration_error"
PLANT_BOUNDS = {
    "momentum_residual": 1e-8,
    "energy_residual": 1e-7,
    "quaternion_residual": 1e-8,
    INTEGRATION_ERROR: 1e-5,
}


def check_expectations(expect: Mapping[str, Expectation], names: Sequence[str]) -> None:
    """Refuse bounds on metrics there will not be, before anything is run.

    Args:
        expect: the experiment's.
        names: see ``metrics.metric_names``.

    Raises:
        SpecError: with the nearest names.
    """
    _check_known(expect, names, "metric", "expect")


def check_bands(bands: Mapping[str, float], axes: Sequence[str]) -> None:
    """Refuse settling bands of axes the robot does not have.

    Raises:
        SpecError: with the nearest names.
    """
    _check_known(bands, axes, "axis", "settling_bands")


def _check_known(given: Iterable[str], names: Sequence[str], what: str, section: str) -> None:
    for name in given:
        if name not in names:
            accepted = nearest(name, names) or ", ".join(names)
            raise SpecError(f"no such {what}", key=f"{section}.{name}", accepted=accepted)


def check_end(end_reason: str | None) -> Check:
    """The run ended by itself."""
    return Check("completed", None, f"the run ends by itself (ended: {end_reason})", end_reason == "completed")


def judge(metrics: RunMetrics, expect: Mapping[str, Expectation], end_reason: str | None) -> tuple[Check, ...]:
    """All checks of a run's numbers; see ``check_expectations`` for what ``expect`` may name."""
    numbers = metrics.flat()
    checks = [check_end(end_reason)]
    for name, bound in PLANT_BOUNDS.items():
        value = numbers[name]
        if value is not None or name != INTEGRATION_ERROR:
            checks.append(Check(name, value, f"<= {bound:g}", value is not None and value <= bound))
    for name, expectation in expect.items():
        checks += check_bounds(name, numbers[name], expectation)
    return tuple(checks)


def check_ticks(
    stamps: Sequence[int] | Stamps, steps: int, period: int, lacks: Callable[[int], str] = lambda tick: ""
) -> Check:
    """The run is there as a whole: every tick that was asked for, the last one too, and no other.

    Args:
        stamps: of the complete ticks, in order [ns].
        steps: number of periods asked for.
        period: control period [ns].
        lacks: says what a tick that is not complete lacks.
    """
    wrong = np.flatnonzero(np.asarray(stamps, dtype=np.int64) != np.arange(len(stamps)) * period)
    missing = int(wrong[0]) if wrong.size else len(stamps)
    whole = len(stamps) == steps + 1 == missing
    wanted = f"{steps + 1} complete ticks up to {steps * period / NANOSECONDS:g} s"
    if not whole and missing <= steps:
        wanted += f"; tick {missing} at {missing * period / NANOSECONDS:g} s {lacks(missing) or 'is not complete'}"
    return Check("ticks", float(len(stamps)), wanted, whole)


def check_bounds(name: str, value: float | None, wanted: Expectation) -> list[Check]:
    """One check per bound an expectation states; a number that is not there keeps none."""
    found = []
    if wanted.value is not None:
        close = value is not None and abs(value - wanted.value) <= wanted.tolerance
        found.append((f"{wanted.value:g} +- {wanted.tolerance:g}", close))
    if wanted.min is not None:
        found.append((f">= {wanted.min:g}", value is not None and value >= wanted.min))
    if wanted.max is not None:
        found.append((f"<= {wanted.max:g}", value is not None and value <= wanted.max))
    about: Literal["budget", "task"] = "task" if name.rpartition(".")[2] in PER_AXIS else "budget"
    return [Check(name, value, words, holds, wanted.id, about=about) for words, holds in found]
