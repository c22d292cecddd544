"""The report's numbers are those a hand calculation gives."""

from __future__ import annotations

import json

import numpy as np
import pinocchio as pin
import pytest

from space_robot_description.load import load_robot
from space_robot_description.reach import Distances, chain_of, reach_of
from space_robot_description.report import coupling_at, robot_report
from space_robot_description.share import shipped
from tests.support.description_texts import TWO_LINKS, actuators, joint, link, robot_file, urdf


def test_mass_and_inertia_by_hand() -> None:
    """Total mass, centre of mass and inertia of mini at home are the sums over its bodies, parallel axes included."""
    robot = load_robot("mini")
    report = robot_report(robot)
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, np.concatenate([pin.neutral(robot.model)[:7], robot.home]))
    coms = np.array([data.oMi[index].act(robot.model.inertias[index].lever) for index in range(1, 6)])
    masses = np.array([body.mass for body in report.bodies])
    com = masses @ coms / masses.sum()
    inertia = np.zeros((3, 3))
    for index, (mass, offset) in enumerate(zip(masses, coms - com, strict=True), start=1):
        turn = data.oMi[index].rotation
        inertia += turn @ robot.model.inertias[index].inertia @ turn.T
        inertia += mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    assert report.total_mass == pytest.approx(36.4, rel=1e-14)
    np.testing.assert_allclose(report.system_com, com, atol=1e-14)
    np.testing.assert_allclose(report.system_inertia, inertia, atol=1e-13)


def test_orthogonal_wheels_hold_their_limit_per_axis() -> None:
    """Three orthogonal wheels hold one wheel's momentum and torque about each body axis."""
    report = robot_report(load_robot("mini"))
    np.testing.assert_allclose(report.momentum_capacity, [2.0] * 3)
    np.testing.assert_allclose(report.torque_capacity, [1.5] * 3)
    assert report.force_capacity is None


def test_pyramid_of_wheels_holds_what_its_geometry_gives() -> None:
    """Four wheels at elevation b hold 2 h cos(b) about x and y and 4 h sin(b) about z."""
    robot = load_robot("panda_sat")
    elevation = np.arctan(0.7)
    expected = [100 * np.cos(elevation), 100 * np.cos(elevation), 200 * np.sin(elevation)]
    np.testing.assert_allclose(robot_report(robot).momentum_capacity, expected, rtol=1e-12)


def test_thrusters_have_no_momentum_capacity() -> None:
    """A robot without wheels has no momentum capacity; its thrusters' limits are its capacities."""
    report = robot_report(load_robot("ets7"))
    assert report.momentum_capacity is None
    np.testing.assert_array_equal(report.torque_capacity, [100.0] * 3)
    np.testing.assert_array_equal(report.force_capacity, [150.0] * 3)


@pytest.mark.parametrize("name", shipped("robots"))
def test_sampled_reach_is_below_the_sum_bound(name: str) -> None:
    """The sampled reach stays between half the bound and the bound, and does not change from call to call."""
    robot = load_robot(name)
    reach = reach_of(robot)
    assert 0.5 * reach.sum_bound < reach.sampled <= reach.sum_bound * (1 + 1e-12)
    assert reach_of(robot) == reach


@pytest.mark.parametrize("name", ["servicer", "panda_gripper", "dual_servicer", "astrobee_like"])
def test_distances_of_many_postures_are_those_of_pinocchio(name: str) -> None:
    """All at once as one by one, so that the posture that Pinocchio finds farthest is among those it is asked of."""
    robot = load_robot(name)
    tip = robot.model.getFrameId(robot.tool_frame, pin.FrameType.BODY)
    distances = Distances(robot, chain_of(robot))
    assert robot.model.frames[tip].parentJoint == chain_of(robot)[-1]
    postures = np.random.default_rng(4).uniform(-3.0, 3.0, (50, robot.n))
    one_by_one = [distances(posture) for posture in postures]
    np.testing.assert_allclose(distances.of_all(postures), one_by_one, rtol=1e-12)
    assert distances(distances.farthest(postures)) == max(one_by_one)


def test_reach_by_hand() -> None:
    """Mini stretched out reaches 0.35 + 0.30 + 0.13 m, ets7 the sum of its links."""
    assert reach_of(load_robot("mini")).sum_bound == pytest.approx(0.78, rel=1e-14)
    assert reach_of(load_robot("mini")).sampled == pytest.approx(0.78, rel=1e-3)
    assert reach_of(load_robot("ets7")).sum_bound == pytest.approx(3.65, rel=1e-14)


def test_reach_of_a_prismatic_joint_counts_its_travel() -> None:
    """A slide of 0.5 m adds 0.5 m."""
    slide = joint("slide", "fore", "hand", "prismatic", '<axis xyz="1 0 0"/><limit lower="0" upper="0.5"/>')
    robot = load_robot(robot_file(urdf(*TWO_LINKS, link("hand"), slide)))
    reach = reach_of(robot)
    assert reach.sum_bound == pytest.approx(0.4 + 0.4 + 0.5)
    assert reach.sampled == pytest.approx(1.3, rel=1e-3)


def test_coupling_predicts_the_base_rate_of_a_floating_robot() -> None:
    """The rate ratio is the largest base rate over unit joint rates at zero momentum, and coupling ignores the pose."""
    robot = load_robot("mini")
    model, data = robot.model, robot.model.createData()
    q = np.concatenate([[1.0, 2.0, 3.0, 0.5, 0.5, 0.5, 0.5], robot.home])
    centroidal = pin.computeCentroidalMap(model, data, q)
    base_rates = -np.linalg.solve(centroidal[:, :6], centroidal[:, 6:])[3:]
    assert coupling_at(robot, robot.home).rate_ratio == pytest.approx(np.linalg.norm(base_rates, 2), rel=1e-12)


def test_heavier_base_couples_less() -> None:
    """The same arm moves a ten times heavier satellite less, and the report shows it."""
    base = {"mass": 50.0, "inertia": [3.0, 4.0, 5.0]}
    heavy = {"mass": 500.0, "inertia": [30.0, 40.0, 50.0]}
    light_report, heavy_report = (robot_report(load_robot(robot_file(base=b))) for b in (base, heavy))
    assert heavy_report.coupling.rate_ratio < 0.2 * light_report.coupling.rate_ratio


def test_to_dict_is_plain_json_without_infinities() -> None:
    """The report survives strict JSON; an unlimited joint has None as limits."""
    free = joint("j2", "upper", "fore", "continuous", '<axis xyz="0 0 1"/>')
    motors = actuators(joints={"effort": 5, "lag": 0.1, "viscous": {"j1": 0.2}})
    report = robot_report(load_robot(robot_file(urdf(*TWO_LINKS[:4], free), actuators=motors))).to_dict()
    assert json.loads(json.dumps(report, allow_nan=False)) == report
    assert report["joints"][1]["upper"] is None
    assert [row["viscous"] for row in report["joints"]] == [0.2, 0.0]
    assert report["joints"][0]["lag"] == 0.1
    assert report["reach"]["sum_bound"] == pytest.approx(0.4)
