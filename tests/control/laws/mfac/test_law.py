"""Model-free control and PD as laws: channels, tracking on articulated robots, Phi(1) from pulses, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_control.channels import Channels
from space_robot_control.laws import make_law
from space_robot_control.laws.mfac.law import ModelFree
from space_robot_control.nominal_model import NominalModel
from space_robot_control.references import make_reference
from space_robot_control.sensing import FilterSpec, Sensing
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_description.rotations import from_rpy
from space_robot_msgs_py.errors import NonFiniteError, SpecError
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector
from tests.support.robots import arm_model, robot_of
from tests.support.simulated import errors, simulate

MOTION: dict[str, Any] = {"kind": "quintic", "duration": 40.0, "attitude_deg": [4, -4, 8], "joints_by_deg": 15}


def home(robot: Robot) -> Vector:
    return np.concatenate([[0, 0, 0, 0, 0, 0, 1.0], robot.home])


def worst(robot: Robot, law: str, gains: dict[str, Any], period: float, start: float = 0.0, **motion: Any) -> float:
    """Largest attitude or joint error [deg] of a smooth motion and 50 s at rest, after ``start`` seconds."""
    spec = MOTION | {"start": start} | motion
    reference, steps = make_reference(spec, robot, home(robot)), round((start + spec["duration"] + 50.0) / period)
    rows = simulate(make_law(law, robot, period, gains), reference, robot, home(robot), period, steps)
    seen = rows[round(start / period) :]
    return float(np.degrees(max(np.abs(errors(seen, label)).max() for label in ("attitude_error", "joint_error"))))


@pytest.mark.parametrize(("name", "period", "bound"), [("mini", 0.1, 0.02), ("mini", 0.5, 0.3), ("servicer", 0.1, 0.1)])
def test_a_smooth_motion_is_followed_by_the_full_matrix(name: str, period: float, bound: float) -> None:
    """With Phi(1) from the nominal model base and arm follow a smooth motion, without any model of the motion."""
    assert worst(load_robot(name), "mfac", {}, period) < bound


def test_pulses_give_the_matrix_the_nominal_model_gives() -> None:
    """Phi(1) from one small pulse train per input is that of the robot, and runs as well."""
    robot = load_robot("mini")
    level = {"roll": 0.05, "pitch": 0.05, "yaw": 0.05, "joint1": 1e-3, "joint2": 1e-3, "joint3": 1e-3, "joint4": 1e-3}
    gains = {"initial": {"source": "pulses", "seconds": 2.0, "level": level}}
    law, q = make_law("mfac", robot, 0.1, gains), home(robot)
    assert isinstance(law, ModelFree)
    exact = np.diag(law.channels.response(NominalModel(robot), q))
    rows = simulate(law, make_reference({"kind": "hold"}, robot, q), robot, q, 0.1, 150)
    telemetry = rows[-1][1]
    np.testing.assert_allclose(telemetry["initial_gain"], exact, rtol=0.05)
    assert rows[10][1]["identifying"][0] == 1.0
    assert telemetry["identifying"][0] == 0.0
    assert 0.0 < telemetry["initial_deviation"].max() < 0.1
    assert worst(robot, "mfac", gains, 0.1, start=20.0) < 0.1


def test_the_estimator_follows_the_configuration() -> None:
    """A frozen Phi(1) loses the mini robot at the end of a longer way, the estimated Phi holds it (c = 1 s)."""
    robot, way = load_robot("mini"), {"duration": 30.0, "attitude_deg": [5, -5, 10], "joints_by_deg": 20}
    assert worst(robot, "mfac", {}, 0.1, **way) < 0.02
    assert worst(robot, "mfac", {"estimator": {"sigma": 0.0}}, 0.1, **way) > 1.0


def test_pd_holds_the_same_channels() -> None:
    """The baseline reaches the target with the same belief; without feed-forward it lags behind on the way."""
    robot = robot_of(arm_model(4), floating=True)
    lag = worst(robot, "pd", {"bandwidth": 0.5}, 0.1)
    assert 0.1 < lag < 10.0


def test_a_law_of_one_channel_moves_only_that_channel() -> None:
    """A law of one output pushes that channel and nothing else, and Phi is a number."""
    robot = load_robot("servicer")
    q = home(robot)
    law = make_law("mfac", robot, 0.1, {"outputs": ["yaw"], "held": list(robot.joint_names)})
    output = law.update(
        RobotState(0, q, np.zeros(14), np.zeros(8), np.zeros(3)),
        make_reference({"kind": "hold", "attitude_deg": [0, 0, 3]}, robot, q).at(0),
    )
    assert np.flatnonzero(output.command.u).tolist() == [5]
    assert output.telemetry["pseudo_gradient"].size == 1


@pytest.mark.parametrize("law", ["mfac", "pd"])
def test_a_wrong_reading_of_the_grasp_does_not_reach_the_response(law: str) -> None:
    """A camera that is wrong at the start, by 0.2 m and 10 deg in the grasp, changes no bit of B."""
    robot = load_robot("pccs")
    grasp, q = list(robot.joint_names[-3:]), home(robot)
    wrong = np.array(q)
    wrong[-3:] += (0.2, 0.0, np.radians(10.0))
    desired = make_reference({"kind": "hold", "attitude_deg": [0, 0, 3]}, robot, q).at(0)
    found = []
    for reading in (q, wrong):
        controller = make_law(law, robot, 0.1, {"outputs": ["yaw"], "held": grasp})
        output = controller.update(RobotState(0, reading, np.zeros(9), np.zeros(3), np.zeros(3)), desired)
        shown = output.telemetry["initial_gain"] if law == "mfac" else output.command.u
        found.append(shown.tobytes())
    assert found[0] == found[1]


def test_the_response_of_a_channel_is_that_of_the_bodies_behind_it() -> None:
    """With all joints held a force moves the whole mass, a torque the whole inertia; free joints give way."""
    robot = load_robot("servicer")
    model, q = NominalModel(robot), home(robot)
    held = Channels(robot, ["x"], robot.joint_names).response(model, q)[0, 0]
    inverse = np.linalg.inv(model.mass_matrix(q)[:6, :6])
    assert held == pytest.approx(inverse[0, 0], rel=1e-12)
    assert Channels(robot, ["x"]).response(model, q)[0, 0] > held


@pytest.mark.parametrize(
    ("gains", "key"),
    [
        ({"outputs": ["jaw"]}, "outputs.*yaw"),
        ({"outputs": ["x"]}, "outputs"),
        ({"outputs": ["yaw", "yaw"]}, "twice"),
        ({"outputs": ["joint1"], "held": ["joint1"]}, "twice"),
        ({"lead": {"yaw": 1.0}}, "lead"),
        ({"form": "position", "output_order": 1}, "output_order"),
        ({"estimator": {"sigma": 3.0}}, "sigma"),
        ({"kappa": -1.0}, "kappa"),
    ],
)
def test_unusable_channels_and_numbers_are_refused_with_their_key(gains: dict[str, Any], key: str) -> None:
    """A channel that is not there, not pushed, or named twice, and numbers out of range: one error with the key."""
    with pytest.raises(SpecError, match=key):
        make_law("mfac", load_robot("mini"), 0.1, gains)


def test_an_unstable_choice_is_warned_of_before_the_run() -> None:
    """The printed rho = 1 on the position output is warned of; the default is not."""
    robot = load_robot("mini")
    path = [make_reference({"kind": "hold"}, robot, home(robot)).at(0)]
    assert make_law("mfac", robot, 0.1).review(path).warnings == ()
    review = make_law("mfac", robot, 0.1, {"form": "position", "rho": 1.0}).review(path)
    assert len(review.warnings) == len(review.facts) == 7
    assert "unstable" in review.warnings[0]
    assert make_law("pd", robot, 1.0, {"bandwidth": 1.5}).review(path).warnings != ()


def test_numbers_that_are_not_finite_never_reach_a_law() -> None:
    """A state with NaN cannot be made: the boundary refuses it before any law sees it."""
    with pytest.raises(NonFiniteError):
        RobotState(0, np.full(7, np.nan), np.zeros(6), np.zeros(0), np.zeros(3))


def test_reset_forgets_everything() -> None:
    """After a reset the same states give the same bits."""
    robot = load_robot("mini")
    reference, q = make_reference(MOTION, robot, home(robot)), home(robot)
    for law in (make_law("mfac", robot, 0.1), make_law("pd", robot, 0.1)):
        first = [u.tobytes() for _, _, u in simulate(law, reference, robot, q, 0.1, 30)]
        assert [u.tobytes() for _, _, u in simulate(law, reference, robot, q, 0.1, 30)] == first


def test_a_moving_reference_is_not_mistaken_for_motion() -> None:
    """A robot at rest under a turning and jumping reference has moved by nothing."""
    robot = load_robot("mini")
    channels, q = Channels(robot), home(robot)
    sensing = Sensing(channels, FilterSpec(), 0.1)
    state = RobotState(0, q, np.zeros(10), np.zeros(4), np.zeros(3))
    for k in range(20):
        goal = q.copy()
        goal[3:7] = from_rpy([0.002 * k, 0.0, 0.3 * (k > 10)])
        goal[7] += 0.5 * (k > 5)
        reference = Reference(0, goal, np.zeros(10), np.zeros(10))
        sensing.update(state, reference)
        assert np.abs(sensing.memory.moved_sample).max() < 1e-12
        assert sensing.refused.sum() == 0
