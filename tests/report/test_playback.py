import numpy as np
import pinocchio as pin
import pytest

from space_robot_description.load import load_robot
from space_robot_report.playback import Footage, joint_axes, way_of
from space_robot_report.viewer.clock import PlayClock
from space_robot_report.viewer.motion import Motion
from tests.support.description_texts import TWO_LINKS, robot_file, urdf
from tests.support.description_texts import joint as joint_text


@pytest.fixture(scope="module")
def robot():
    return load_robot("mini")


def film_of(model, count=5):
    rng = np.random.default_rng(0)
    q = np.array([pin.integrate(model, pin.neutral(model), 0.3 * rng.normal(size=model.nv)) for _ in range(count)])
    pushes = rng.normal(size=(count, 3)), rng.normal(size=(count, model.nv - 6))
    return Footage(0.5 * np.arange(count), q, q[::-1].copy(), *pushes)


def test_at_a_tick_the_log_is_shown_and_between_two_the_middle(robot):
    """At a tick everything is that of the log; between two, the configuration lies on the shortest way."""
    film = film_of(robot.model)
    motion = Motion(robot.model, film)
    for row, time in enumerate(film.time):
        moment = motion.at(time)
        np.testing.assert_allclose(moment.q, film.q[row], atol=1e-12)
        assert (moment.torque == film.torque[row]).all()
    half = pin.difference(robot.model, film.q[1], motion.at(0.75).q)
    np.testing.assert_allclose(half, 0.5 * pin.difference(robot.model, film.q[1], film.q[2]), atol=1e-9)
    assert (motion.at(0.99).efforts == film.efforts[1]).all()


@pytest.mark.parametrize("time", [-3.0, 99.0])
def test_outside_of_the_run_its_ends_are_shown(robot, time):
    """Before the first tick the first is shown, after the last the last."""
    film = film_of(robot.model)
    moment = Motion(robot.model, film).at(time)
    np.testing.assert_allclose(moment.q, film.q[0 if time < 0.0 else -1], atol=1e-12)


def test_a_run_of_one_tick_can_be_shown(robot):
    """A log cut after its first tick stands still."""
    film = film_of(robot.model, 1)
    np.testing.assert_allclose(Motion(robot.model, film).at(0.3).q, film.q[0], atol=1e-12)


def test_joint_axes_are_those_the_robot_turns_about(robot):
    """A small motion of a joint turns its body by the axis, seen from the body."""
    model, data = robot.model, robot.model.createData()
    axes = joint_axes(model)
    assert len(axes) == model.njoints - 2
    for joint, axis in enumerate(axes, start=2):
        rates = np.zeros(model.nv)
        rates[model.joints[joint].idx_v] = 1.0
        pin.forwardKinematics(model, data, pin.neutral(model), rates)
        np.testing.assert_allclose(data.v[joint].angular, axis, atol=1e-12)


def test_the_trace_of_a_link_equals_forward_kinematics(robot):
    """Positions are those of forward kinematics, tick by tick."""
    film = film_of(robot.model)
    data = robot.model.createData()
    for q, position in zip(film.q, way_of(robot.model, film.q, robot.tool_frame), strict=True):
        pin.framesForwardKinematics(robot.model, data, q)
        expected = data.oMf[robot.model.getFrameId(robot.tool_frame)].translation
        np.testing.assert_allclose(position, expected, atol=1e-12)


def test_the_clock_plays_pauses_ends_and_begins_anew():
    """Time passes by speed while it plays, stops at the end, and starts over when played there."""
    clock = PlayClock(0.0, 10.0)
    assert not clock.advance(1.0)
    clock.toggle()
    clock.speed = 4.0
    assert clock.advance(1.0)
    assert (clock.now, clock.playing) == (4.0, True)
    clock.toggle()
    clock.advance(1.0)
    assert clock.now == 4.0
    clock.seek(99.0)
    assert clock.now == 10.0
    clock.toggle()
    assert (clock.now, clock.playing) == (0.0, True)
    clock.advance(100.0)
    assert (clock.now, clock.playing) == (10.0, False)


def test_a_link_is_found_beside_a_joint_of_its_name():
    """The way of a link is drawn where a joint has the same name: frames are looked up with their kind."""
    robot = load_robot(
        robot_file(urdf(*TWO_LINKS[:3], joint_text("upper", "base_link", "upper"), joint_text("fore", "upper", "fore")))
    )
    other = load_robot(robot_file())
    q = np.concatenate([pin.neutral(other.model)[:7], [0.3, -0.4]])[None]
    np.testing.assert_array_equal(way_of(robot.model, q, "fore"), way_of(other.model, q, "fore"))
