"""What an experiment will run into is said by `check`: momentum, efforts, friction and fast modes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import compose_world
from space_robot_bringup.compose.foresight import foreseen
from space_robot_bringup.experiment.experiment import experiment_from
from space_robot_control.laws.policy import TYPED
from tests.support.description_texts import actuators, robot_file

WHEELS = {"kind": "reaction_wheels", "torque": 5.0, "momentum": 2.0}
MOVE = {"kind": "quintic", "duration": 10.0, "joints": [0.5, 0.2]}


def _foreseen(robot: Any = None, **changes: Any) -> tuple[str, ...]:
    data: dict[str, Any] = {"robot": robot or robot_file(), "control_period": 0.1, "duration": 12.0, "reference": MOVE}
    data["controller"] = {"law": "computed_torque"}
    return foreseen(compose_world(experiment_from(data | changes, "test"), TYPED))


def _robot(**motors: Any) -> dict[str, Any]:
    return robot_file(actuators=actuators(joints={"effort": 5.0} | motors))


def test_an_ordinary_experiment_is_not_warned_of() -> None:
    """A motion within all limits has nothing to be said of."""
    assert _foreseen() == ()


@pytest.mark.parametrize(("rate", "stored", "count"), [(0.01, 0.0, 0), (5.0, 0.0, 1), (0.1, 1.99, 1), (0.1, -1.99, 0)])
def test_momentum_beyond_the_wheels_is_foreseen(rate: float, stored: float, count: int) -> None:
    """A robot that starts with more momentum than its wheels can take once it rests is named."""
    wheels = WHEELS | {"initial_momentum": [0.0, 0.0, stored]}
    initial = {"angular_velocity": [0.0, 0.0, rate]}
    warnings = _foreseen(robot_file(actuators=actuators(base_torque=wheels)), initial=initial)
    assert len(warnings) == count
    assert all("limit is 2 N m s" in warning for warning in warnings)


def test_efforts_beyond_the_limits_are_foreseen() -> None:
    """A reference that needs more than a motor or the base has is named with place, number, time and limit."""
    fast = MOVE | {"duration": 0.5}
    weak = _robot(effort=0.5)
    warnings = _foreseen(weak, reference=fast)
    places = [warning.split(":")[0] for warning in warnings]
    assert "joint j1" in places
    assert all(warning.split(":")[1].startswith(" the reference needs ") for warning in warnings)
    assert warnings[places.index("joint j1")].endswith("the limit is 0.5")
    assert _foreseen(weak) == ()


def test_noise_of_the_wheels_that_least_squares_do_not_expect_is_foreseen() -> None:
    """Two readings over a period are a torque: a noise above rls.torque_noise is named."""
    robot = robot_file(actuators=actuators(base_torque=WHEELS))

    def warnings(noise: float, **rls: Any) -> tuple[str, ...]:
        plant = {"sensors": {"wheel_momentum": {"noise": noise}}}
        return _foreseen(robot, plant=plant, controller={"law": "adaptive", "gains": {"rls": rls}})

    (warning,) = warnings(0.01)
    assert "noise of 0.141 N m, of which it takes 0.001 (rls.torque_noise)" in warning
    assert warnings(1e-4) == warnings(0.01, torque_noise=0.15) == warnings(0.01, wheel_torque="commanded") == ()


def test_friction_that_the_law_does_not_know_is_foreseen() -> None:
    """Friction is named with the law that does not know it, and what lets it know."""
    (warning,) = _foreseen(_robot(viscous=0.1))
    assert "friction (viscous up to 0.1), which computed_torque does not know" in warning
    assert "see nominal.friction" in warning
    assert _foreseen(_robot(viscous=0.1), nominal={"friction": True}) == ()
    # A law of the user may know it.
    assert _foreseen(_robot(coulomb=0.1), controller={"law": "own.py:Mine"}) == ()


def test_modes_faster_than_the_period_are_foreseen() -> None:
    """Friction that stops a joint between two commands and motors slower than the period are named."""
    warnings = _foreseen(_robot(viscous=50.0), nominal={"friction": True}, reference={"kind": "hold"})
    assert [warning.startswith("friction slows a joint down within") for warning in warnings] == [True]
    (warning,) = _foreseen(_robot(lag=0.5))
    assert "motors lag by 0.5 s, longer than the control period of 0.1 s" in warning
    assert np.isfinite(float(warning.split()[3]))
