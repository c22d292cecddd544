"""A command that acts one period late, and laws that know of it (``nominal.delay_periods``)."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import space_robot as sr
from space_robot_bringup import load_experiment
from space_robot_bringup.compose.composition import compose
from space_robot_control import Blocks, Law
from space_robot_control.command_delay import NO_COMMAND, CommandDelay
from space_robot_msgs_py import Command, Reference, RobotState, Vector
from space_robot_sim.command_hold import CommandHold


class Listening(Law):
    """Keeps the applied commands it gets."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.heard: list[tuple[int, bool]] = []

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Nothing."""
        return np.zeros(6 + self.n), {}

    def on_applied(self, command: Command, *, own: bool) -> None:
        """Keep it."""
        self.heard.append((command.stamp, own))


LATE = {"plant.delay_periods": 1}
KNOWN = LATE | {"nominal.delay_periods": 1}
# An axis so far off has not been controlled for some time [deg].
LOST = 90.0


def ran(name: str, overrides: dict[str, object]) -> sr.Run:
    """A run in memory; what it warns of is another test's."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return sr.run(name, overrides)


def max_errors(run: sr.Run) -> tuple[float, float]:
    """The largest errors of base and joints [deg]."""
    errors = [axis.max_error for axis in run.metrics.axes]
    return max(errors[:3]), max(errors[3:])


@pytest.mark.parametrize("periods", [0, 1])
def test_the_flight_software_and_the_plant_agree_on_what_acts(periods: int) -> None:
    """The applied command that a law gets in each period is the one that the plant applies."""
    plant = CommandHold(2, delay_periods=periods, hold="zero")
    law = CommandDelay(periods, none="nothing")
    for k in range(5):
        command = Command(k, np.full(6, 1.0 + k), np.full(2, 1.0 + k))
        applied, (known, owner) = plant.take(command), law.acting(command, f"law {k}")
        np.testing.assert_array_equal(known.u, applied.u)
        assert (known.stamp, owner) == (
            (NO_COMMAND, "nothing") if k < periods else (applied.stamp, f"law {k - periods}")
        )


def test_least_squares_learn_from_the_command_that_acted() -> None:
    """Fig. 11 with a late command: the estimate loses its mass, or, knowing of the delay, tracks below 0.2 deg."""
    unaware, aware = ran("liu2023/fig11", LATE), ran("liu2023/fig11", KNOWN)
    assert unaware.reason.startswith("controller: adaptive: parameters (total mass)")
    assert aware.reason == "completed"
    base, joints = max_errors(aware)
    assert base < 0.1
    assert joints < 0.2


def test_a_model_free_law_predicts_what_the_command_under_way_does() -> None:
    """With a late command the outputs diverge; knowing of it the law settles within 0.1 deg."""
    mfac = {"controller.law": "mfac"}
    unaware, aware = ran("compare/mini", mfac | LATE), ran("compare/mini", mfac | KNOWN)
    assert max(max_errors(unaware)) > LOST
    assert aware.reason == "completed"
    assert max(axis.final_error for axis in aware.metrics.axes) < 0.1


def test_a_disturbance_observer_compares_with_the_command_that_acted() -> None:
    """With a late command it takes its own commands for a disturbance and diverges; knowing the delay it does not."""
    controller = {"controller": {"law": "ntsmc", "gains": {"disturbance_observer": 0.5}}}
    prompt, unaware, aware = (ran("liu2023/fig11", controller | late) for late in ({}, LATE, KNOWN))
    assert (prompt.reason, aware.reason) == ("completed", "completed")
    assert max(max_errors(unaware)) > LOST
    estimates = [np.abs(run.arrays.telemetry.controller["disturbance_estimate"]).max() for run in (prompt, aware)]
    assert estimates[1] < 2.0 * estimates[0]


def test_a_switch_passes_on_whose_command_acts() -> None:
    """With a delay the command after a switch is still the other law's, and the law in charge knows."""
    law = f"{__name__}:Listening"
    standby = f"standby: {{other: {{law: '{law}'}}}}, switches: [{{time: 1.0, to: other}}], handover: 0"
    sets = [f"controller={{law: '{law}', {standby}}}", "nominal.delay_periods=1"]
    composition = compose(load_experiment("liu2023/fig08", sets))
    switching, source = composition.controller(), composition.reference()
    q, v = composition._q0, composition._v0
    for k in range(8):
        stamp = k * composition.experiment.period
        switching.update(RobotState(stamp, q, v, np.zeros(switching.n), np.zeros(3)), source.at(stamp))
    first, other = switching._laws.values()  # type: ignore[attr-defined]
    stamps = [NO_COMMAND, *(k * composition.experiment.period for k in range(7))]
    assert first.heard == [(stamp, 0 < k <= 4) for k, stamp in enumerate(stamps)]
    assert other.heard == [(stamp, k > 4) for k, stamp in enumerate(stamps)]


@pytest.mark.parametrize(
    ("overrides", "warned"),
    [
        (LATE, "plant.delay_periods=1, but the law knows of 0: see nominal.delay_periods"),
        (KNOWN | {"controller.law": "pd", "controller.gains": {}}, "pd takes no account of nominal.delay_periods=1"),
        (KNOWN, ""),
    ],
)
def test_a_delay_that_a_law_does_not_know_is_warned_of(overrides: dict[str, object], warned: str) -> None:
    """Before the run, with the key to set."""
    warnings = compose(load_experiment("liu2023/fig11", overrides)).review().warnings
    assert [text for text in warnings if "delay" in text] == ([warned] if warned else [])
