"""Computed torque: convergence, exact error dynamics, zero force, and the limit of sampling."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from space_robot_control.laws import law_class, make_law
from space_robot_control.references import make_reference
from space_robot_control.sampled_stability import stability_margin
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector
from tests.support.paths import ROOT
from tests.support.robots import arm_model, robot_of
from tests.support.simulated import errors, simulate, start

EXAMPLE = f"{ROOT / 'examples' / 'my_law.py'}:PdPlus"
N = 4
ARM = arm_model(N)


@pytest.mark.parametrize("floating", [True, False])
@pytest.mark.parametrize("period", [0.1, 1.0])
def test_a_large_step_is_reached_and_kept(floating: bool, period: float) -> None:
    """From 120 degrees and half a metre off, every controlled error vanishes, at 0.1 s and at 1 s."""
    robot = robot_of(ARM, floating=floating)
    target = {"kind": "hold", "position": [0.3, -0.4, 0.0], "joints": [0.0, 0.4, -0.2, 0.9]}
    reference = make_reference(target, robot, start())
    law = make_law("computed_torque", robot, period, {"bandwidth": 0.3})
    rows = simulate(
        law, reference, robot, start((1.0, -1.5, 1.0)), period, round(80 / period), substeps=round(20 * period)
    )
    assert np.linalg.norm(errors(rows, "attitude_error")[0]) > 2.0
    for label in ("attitude_error", "joint_error", "joint_rate_error", *(() if floating else ("position_error",))):
        assert np.abs(errors(rows, label)[-1]).max() < 1e-6, label


def test_free_floating_base_gets_exactly_no_force_and_keeps_its_momentum() -> None:
    """Every commanded force is 0.0 to the bit, and the plant's linear momentum stays zero."""
    robot = robot_of(ARM, floating=True)
    reference = make_reference({"kind": "hold", "joints": [0.0, 0.4, -0.2, 0.9]}, robot, start())
    rows = simulate(make_law("computed_torque", robot, 0.1), reference, robot, start((0.4, 0.0, 0.2)), 0.1, 100)
    data = ARM.createData()
    for state, _, u in rows:
        assert u[:3].tolist() == [0.0, 0.0, 0.0]
        momentum = pin.computeCentroidalMomentum(ARM, data, state.q, state.v)
        np.testing.assert_allclose(momentum.linear, 0.0, atol=1e-5)
    assert np.abs(rows[-1][2][3:]).max() > 0.0


@pytest.mark.parametrize("floating", [True, False])
@pytest.mark.parametrize("damping", [0.6, 1.0])
def test_errors_follow_the_second_order_response_up_to_the_period(floating: bool, damping: float) -> None:
    """Attitude (one axis), joint and position errors obey e'' + 2 zeta wn e' + wn^2 e = 0 with a deviation O(T)."""
    robot, wn, axis = robot_of(ARM, floating=floating), 0.8, np.array([2.0, -1.0, 2.0]) / 3.0
    goal = {"kind": "hold", "position": [0.2, 0.1, -0.3], "joints": [0.5, -0.6, 0.4, 0.1]}
    reference, deviation = make_reference(goal, robot, start()), []
    for period in (0.1, 0.05):
        law = make_law("computed_torque", robot, period, {"bandwidth": wn, "damping": damping})
        rows = simulate(law, reference, robot, start(tuple(-0.7 * axis)), period, round(6 / period))
        shape = second_order(np.arange(len(rows)) * period, wn, damping)
        offset = errors(rows, "joint_error") - np.outer(shape, errors(rows, "joint_error")[0])
        turned = errors(rows, "attitude_error") - np.outer(shape, 0.7 * axis)
        worst = [np.abs(offset).max(), np.abs(turned).max()]
        if not floating:
            away = np.array([0.2, 0.1, -0.3]) - np.array([state.q[:3] for state, _, _ in rows])
            worst.append(np.abs(away - np.outer(shape, away[0])).max())
        deviation.append(max(worst))
    assert deviation[0] < 0.1
    assert deviation[0] / deviation[1] == pytest.approx(2.0, abs=0.35)


def second_order(t: Vector, wn: float, damping: float) -> Vector:
    """Free response from 1 at rest of e'' + 2 zeta wn e' + wn^2 e = 0."""
    if damping == 1.0:
        return (1.0 + wn * t) * np.exp(-wn * t)
    wd = wn * np.sqrt(1.0 - damping * damping)
    return np.exp(-damping * wn * t) * (np.cos(wd * t) + damping * wn / wd * np.sin(wd * t))


@pytest.mark.parametrize("floating", [True, False])
def test_a_moving_reference_is_followed_by_the_feed_forward(floating: bool) -> None:
    """On a reference that turns base and arm the error halves with the period: the hold's, with no lag behind it."""
    robot = robot_of(ARM, floating=floating)
    wave = {"amplitude_deg": 20.0, "frequency": 0.05}
    spec = {"kind": "harmonic", "roll": wave, "yaw": wave, "joints": [wave] * N, "soft_start": 10.0}
    if not floating:
        spec["x"] = {"amplitude": 0.2, "frequency": 0.04}
    reference, worst = make_reference(spec, robot, start()), []
    for period in (0.1, 0.05):
        rows = simulate(
            make_law("computed_torque", robot, period), reference, robot, start(), period, round(20 / period)
        )
        labels = ("attitude_error", "joint_error", *(() if floating else ("position_error",)))
        worst.append(max(np.abs(errors(rows, label)).max() for label in labels))
    assert worst[0] / worst[1] == pytest.approx(2.0, abs=0.05)


def test_the_law_believes_the_nominal_robot() -> None:
    """A heavier truth changes the run, never the answer to one and the same state."""
    nominal, heavy = robot_of(arm_model(N), floating=True), robot_of(arm_model(N), floating=True)
    heavy.model.inertias[2] = pin.Inertia(60.0, np.zeros(3), 5.0 * np.eye(3))
    reference = make_reference({"kind": "hold", "joints": [0.0] * N}, nominal, start())
    law = make_law("computed_torque", nominal, 0.1)
    own, other = (simulate(law, reference, truth, start(), 0.1, 20) for truth in (nominal, heavy))
    assert (own[0][2] == other[0][2]).all()
    assert not np.allclose(own[-1][0].q, other[-1][0].q)
    replayed = make_law("computed_torque", nominal, 0.1)
    for state, _, u in other:
        assert (replayed.update(state, reference.at(state.stamp)).command.u == u).all()


@pytest.mark.parametrize("damping", [0.1, 0.3, 0.5, 0.7, 1.0, 2.0])
@pytest.mark.parametrize("share", [0.2, 0.9, 0.999, 1.001, 1.5])
def test_stability_margin_is_where_the_spectral_radius_passes_one(damping: float, share: float) -> None:
    """The closed form agrees with the eigenvalues of the sampled loop on both sides of the limit."""
    period = 0.25
    wn = share * stability_margin(period, 1.0, damping)
    kp, kd = wn * wn, 2.0 * damping * wn
    step = np.array([[1 - kp * period**2 / 2, period - kd * period**2 / 2], [-kp * period, 1 - kd * period]])
    radius = np.abs(np.linalg.eigvals(step)).max()
    assert (radius < 1.0) == (stability_margin(period, wn, damping) > 1.0) == (share < 1.0)


def test_bandwidth_zero_has_no_limit() -> None:
    """A DoF without feedback cannot be made unstable by sampling."""
    assert stability_margin(1.0, 0.0, 1.0) == np.inf


def test_gains_outside_the_stable_region_are_refused_unless_asked_for() -> None:
    """The error names the worst channel and the largest bandwidth; allow_unstable is a deliberate way past."""
    robot = robot_of(ARM, floating=False)
    gains = {"bandwidth": {"joints": {"joint_0": 0.5, "joint_1": 0.5, "joint_2": 1.2, "joint_3": 0.5}}}
    with pytest.raises(SpecError, match=r"bandwidth.joints \(joint_2\).*every 1 s.*got 1.2; accepted: below 1 rad/s"):
        make_law("computed_torque", robot, 1.0, gains)
    assert make_law("computed_torque", robot, 1.0, {**gains, "allow_unstable": True}).control_period == 1.0
    assert make_law("computed_torque", robot, 0.5, gains).control_period == 0.5


def test_bandwidth_of_an_unused_translation_is_not_checked() -> None:
    """A free-floating robot's translation is not controlled, so its bandwidth cannot be unstable."""
    gains = {"bandwidth": {"translation": 50.0}}
    with pytest.raises(SpecError, match="translation"):
        make_law("computed_torque", robot_of(ARM), 0.1, gains)
    assert make_law("computed_torque", robot_of(ARM, floating=True), 0.1, gains).n == N


def test_unstable_gains_really_diverge() -> None:
    """Just above the limit a tiny joint error grows, just below it shrinks: the check is neither lax nor strict."""
    robot = robot_of(ARM)
    reference = make_reference({"kind": "hold"}, robot, start())
    q = start()
    q[10] += 1e-6
    ends = []
    for bandwidth in (1.8, 2.2):
        gains = {"bandwidth": bandwidth, "allow_unstable": True}
        rows = simulate(make_law("computed_torque", robot, 0.5, gains), reference, robot, q, 0.5, 60, substeps=2)
        ends.append(np.abs(errors(rows, "joint_error")[-1]).max())
    assert ends[0] < 1e-9
    assert ends[1] > 1e-5


def test_telemetry_shows_the_errors_and_the_commanded_acceleration() -> None:
    """Labels and sizes are those documented, for free motion too."""
    robot = robot_of(ARM, floating=True)
    reference = make_reference({"kind": "hold"}, robot, start())
    rows = simulate(make_law("computed_torque", robot, 0.1), reference, robot, start((0.1, 0.0, 0.0)), 0.1, 2)
    telemetry = rows[0][1]
    assert dict(zip(telemetry.labels, telemetry.sizes, strict=True)) == {
        "position_error": 3,
        "attitude_error": 3,
        "joint_error": N,
        "twist_error": 6,
        "joint_rate_error": N,
        "acceleration_command": 6 + N,
    }
    np.testing.assert_allclose(telemetry["attitude_error"], [-0.1, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(telemetry["acceleration_command"][3:6], [-0.025, 0.0, 0.0], atol=1e-15)
    free = simulate(make_law("none", robot, 0.1), reference, robot, start((0.1, 0.0, 0.0)), 0.1, 2)[1]
    assert free[2].tolist() == [0.0] * (6 + N)
    assert free[1].labels == telemetry.labels[:-1]


@pytest.mark.parametrize("floating", [True, False])
def test_the_example_law_converges(floating: bool) -> None:
    """The user's law of the examples brings base and arm to rest at the target."""
    robot = robot_of(ARM, floating=floating)
    reference = make_reference({"kind": "quintic", "joints": [0.0, 0.4, -0.2, 0.9], "duration": 20}, robot, start())
    example = law_class(EXAMPLE)
    rows = simulate(example(robot, 0.1), reference, robot, start((0.0, 0.0, 0.05)), 0.1, 1200)
    assert np.abs(errors(rows, "attitude_error")[-1]).max() < 1e-6
    assert np.abs(errors(rows, "joint_error")[-1]).max() < 1e-6
