"""Wheels whose momentum laws do not know (``nominal.wheels: false``): the same for all laws, compiled or not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import experiment_from, to_yaml
from space_robot_bringup.fused.run import compiled_run
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_bringup.modes.hooks import Hooks
from space_robot_control.laws.registry import BUILT_IN, law_class
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import RobotState, Vector

UNKNOWN = {"wheels": False}
HELD = np.array([0.5, -0.3, 0.4])  # [N m s]
TURN = {"kind": "quintic", "duration": 4.0, "joints_by_deg": 10.0, "attitude_deg": [20, -10, 30]}
LEFT_OUT = {"gyroscopic": False}


def composed(law: str, gains: dict[str, Any] | None = None, **parts: Any) -> Composition:
    """A turn of the whole robot, whose wheels are measured."""
    data = {"robot": "mini", "control_period": 0.1, "duration": 3.0, "reference": TURN}
    controller = {"law": law, "gains": gains or {}}
    return compose(experiment_from({**data, "controller": controller, **parts}, "test"))


def command(composition: Composition) -> Vector:
    """(6+n,) of a law that has read HELD of its wheels, on a base that turns."""
    law, stamp = composition.controller(), 10**9
    q, v = composition.initial
    v = v + np.array([0, 0, 0, 0.1, 0.2, -0.1, *np.zeros(composition.nominal.n)])
    state = RobotState(stamp, q, v, np.zeros(composition.nominal.n), np.zeros(3), wheel_momentum=HELD)
    return law.update(state, composition.reference().at(stamp)).command.u


@pytest.mark.parametrize("law", BUILT_IN)
def test_every_law_takes_the_momentum_for_zero(law: str) -> None:
    """The command is that of the law without the gyroscopic torque of its wheels, whatever is read of them."""
    counts = "gyroscopic" in law_class(law).Gains.model_fields
    found, without = command(composed(law, nominal=UNKNOWN)), command(composed(law, LEFT_OUT if counts else None))
    assert np.array_equal(found, without)
    assert np.array_equal(command(composed(law)), without) == (not counts)


@pytest.mark.parametrize("law", ["adaptive", "computed_torque", "lqr"])
def test_a_run_is_the_same_in_the_loop_and_compiled(law: str) -> None:
    """Wheels that are not known change no bit between the two, and the run is that of a law that leaves them out."""
    rows = []
    for composition in (composed(law, nominal=UNKNOWN), composed(law, LEFT_OUT)):
        ticks = [run_in_memory(composition, hooks).ticks for hooks in (None, Hooks())]
        rows += [np.array([tick.output.command.u for tick in one]) for one in ticks]
    assert all(np.array_equal(one, rows[0]) for one in rows)


def test_a_compiled_law_stays_compiled() -> None:
    """A study with unknown wheels is as fast as one with known ones."""
    assert compiled_run(composed("computed_torque", nominal=UNKNOWN), 3) is not None


def test_what_does_not_ask_for_it_is_as_before() -> None:
    """The resolved experiment has a word of it only where laws do not know the wheels."""
    assert "wheels" not in to_yaml(composed("pd", nominal={"wheels": True}).experiment).split("nominal:")[1]
    assert "wheels: false" in to_yaml(composed("pd", nominal=UNKNOWN).experiment).split("nominal:")[1]


def test_a_robot_without_wheels_has_none_to_be_unknown() -> None:
    """Thrusters store nothing: the key is refused, with its value and what is accepted."""
    with pytest.raises(SpecError, match=r"nominal\.wheels: there are no wheels; got False; accepted: a robot with"):
        composed("pd", robot="servicer", reference={"kind": "hold"}, nominal=UNKNOWN)
