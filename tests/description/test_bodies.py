"""Bodies are judged as they move: what is welded together counts as one, and limits of bodies are bodies."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from space_robot_description.changed_inertia import nearest_inertia
from space_robot_description.dispersion import Dispersion, disperse
from space_robot_description.inertia import inertial_parameters
from space_robot_description.load import load_robot
from space_robot_description.mass_matrix import mass_matrix
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import InertiaError, SpecError
from space_robot_msgs_py.interfaces import Vector
from tests.support.description_texts import TWO_LINKS, joint, link, robot_file, urdf

IMPOSSIBLE = '<inertial><mass value="0.5"/><inertia ixx="0.001" iyy="0.001" izz="0.01"/></inertial>'
CROSSED = '<axis xyz="1 0 0"/><limit lower="-2" upper="2" effort="7" velocity="3"/>'
OFF_AXIS = '<inertial><origin xyz="0.2 0.1 0.1"/><mass value="2"/>{}</inertial>'


def _with_fore(inside: str) -> Robot:
    return load_robot(robot_file(urdf(*TWO_LINKS[:2], link("fore", inside), *TWO_LINKS[3:])))


def _mass_matrix(robot: Robot) -> Vector:
    return mass_matrix(robot.model, np.concatenate([pin.neutral(robot.model)[:7], robot.home]))


def test_an_impossible_part_of_a_possible_body_is_accepted() -> None:
    """A link against the triangle inequality that is fixed to another counts with the body that moves."""
    welded = [link("tip", IMPOSSIBLE), joint("weld", "fore", "tip", "fixed")]
    robot = load_robot(robot_file(urdf(*TWO_LINKS, *welded)))
    assert robot.model.inertias[3].mass == 2.5


LIMITS = {
    "point without inertia": OFF_AXIS.format(""),
    "point with zeros": OFF_AXIS.format('<inertia ixx="0" iyy="0" izz="0"/>'),
    "rod": OFF_AXIS.format('<inertia ixx="0" iyy="1" izz="1"/>'),
    "negative by round-off": OFF_AXIS.format('<inertia ixx="-2e-22" iyy="3e-6" izz="3e-6"/>'),
    "nothing but round-off": OFF_AXIS.format('<inertia ixx="-2e-35" iyy="0" izz="2e-35"/>'),
}


@pytest.mark.parametrize("case", LIMITS)
def test_points_and_rods_are_bodies(case: str) -> None:
    """A moving point mass or rod has a positive definite mass matrix as long as it is off its axis, and is accepted."""
    robot = _with_fore(LIMITS[case])
    assert np.all(np.linalg.eigvalsh(_mass_matrix(robot)) > 0.0)


def test_point_mass_is_its_mass_at_a_distance() -> None:
    """The inertia about the joint is mass times distance squared."""
    robot = _with_fore(OFF_AXIS.format(""))
    assert _mass_matrix(robot)[-1, -1] == pytest.approx(2.0 * (0.2**2 + 0.1**2), rel=1e-14)


def test_massless_link_between_two_axes_is_accepted() -> None:
    """A universal joint has a link without mass between two axes; its mass matrix is positive definite."""
    parts = (link("base_link"), link("cross", ""), link("fore"))
    text = urdf(*parts, joint("j1", "base_link", "cross"), joint("j2", "cross", "fore", inside=CROSSED))
    robot = load_robot(robot_file(text))
    assert robot.model.inertias[2].mass == 0.0
    assert np.all(np.linalg.eigvalsh(_mass_matrix(robot)) > 0.0)
    drawn = disperse(robot, Dispersion(eta=0.3), np.random.default_rng(0))
    assert np.isfinite(inertial_parameters(drawn)).all()
    assert inertial_parameters(drawn)[1].tobytes() == inertial_parameters(robot)[1].tobytes()


def test_massless_link_between_equal_axes_is_refused() -> None:
    """Two axes in one line around nothing leave a direction without inertia."""
    inline = joint("j2", "cross", "fore").replace('xyz="0.4 0 0" rpy="0.1 0 0"', 'xyz="0 0 0"')
    text = urdf(link("base_link"), link("cross", ""), link("fore"), joint("j1", "base_link", "cross"), inline)
    with pytest.raises(InertiaError, match=r"link (cross|fore): the mass matrix is singular at home"):
        load_robot(robot_file(text))


def test_points_may_deviate() -> None:
    """A dispersed point mass stays one, and is no draw to be rejected."""
    robot = _with_fore(OFF_AXIS.format(""))
    drawn = disperse(robot, Dispersion(parameters={"bodies.*.mass": 0.1}), np.random.default_rng(1))
    assert drawn.model.inertias[3].mass != 2.0
    assert not np.any(np.abs(drawn.model.inertias[3].inertia) > 1e-12)


def _projected(links: list[str], **changes: Any) -> Robot:
    parts = (*TWO_LINKS[:2], link("fore", IMPOSSIBLE), *TWO_LINKS[3:])
    return load_robot(robot_file(urdf(*parts), inertia={"project": links}, **changes))


def test_projection_makes_the_nearest_body_and_says_so() -> None:
    """An impossible body is refused with the key that repairs it; repaired, it is at the edge of what can exist."""
    with pytest.raises(InertiaError, match=r"triangle inequality.*or inertia: \{project: \[fore\]\} in the robot file"):
        _with_fore(IMPOSSIBLE)
    robot = _projected(["fore"])
    body = robot.model.inertias[3]
    np.testing.assert_allclose(np.diag(body.inertia), [0.005, 0.005, 0.01], rtol=1e-14)
    assert robot.notes == (
        "link fore: inertia projected to the nearest that can exist, "
        "principal moments 0.001, 0.001, 0.01 -> 0.005, 0.005, 0.01 kg m2",
    )
    again = load_robot(json.loads(json.dumps(robot.resolved)))
    assert again.urdf == robot.urdf
    assert inertial_parameters(again).tobytes() == inertial_parameters(robot).tobytes()


@pytest.mark.parametrize("seed", range(5))
def test_projection_is_the_nearest(seed: int) -> None:
    """No possible inertia near the projection is nearer in second moments, and possible ones stay as they are."""
    rng = np.random.default_rng(seed)

    def moments(inertia: Vector) -> Vector:
        return 0.5 * np.trace(inertia) * np.eye(3) - inertia

    given = rng.normal(size=(3, 3))
    given = given + given.T
    found = nearest_inertia(given)
    assert np.linalg.eigvalsh(moments(found))[0] > -1e-12
    np.testing.assert_allclose(nearest_inertia(found), found, atol=1e-12)
    for _ in range(50):
        root = np.linalg.cholesky(moments(found) + 1e-3 * np.eye(3)) + 0.05 * rng.normal(size=(3, 3))
        assert np.linalg.norm(root @ root.T - moments(given)) >= np.linalg.norm(moments(found) - moments(given)) - 1e-12


BAD_CHANGES: dict[str, tuple[dict[str, Any], str]] = {
    "unknown": ({"project": ["for"]}, "inertia.project: no such link; got 'for'; accepted: fore"),
    "possible": ({"project": ["upper"]}, "inertia.project: the inertia of this link can exist; got 'upper'"),
    "replace unknown": ({"replace": {"fo": [1, 1, 1]}}, "inertia.replace.fo: no such link"),
    "entries": ({"replace": {"fore": [1, 1]}}, "inertia.replace.fore: wrong number of values"),
    "impossible": ({"replace": {"fore": [1, 1, 3]}}, "link fore: inertia violates the triangle inequality"),
}


@pytest.mark.parametrize("case", BAD_CHANGES)
def test_changes_that_cannot_be_made_are_refused(case: str) -> None:
    """What the robot file changes in inertias has to fit the robot; the error is one line with the key."""
    changes, message = BAD_CHANGES[case]
    with pytest.raises((SpecError, InertiaError)) as error:
        load_robot(robot_file(inertia=changes))
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_replaced_inertia_is_that_of_the_robot_file() -> None:
    """A tensor of the robot file stands in link axes, whatever the URDF's were, and is said."""
    turned = OFF_AXIS.format('<inertia ixx="1" iyy="1" izz="1"/>').replace("<origin", '<origin rpy="0 0 1"')
    parts = (*TWO_LINKS[:2], link("fore", turned), *TWO_LINKS[3:])
    robot = load_robot(robot_file(urdf(*parts), inertia={"replace": {"fore": [0.1, 0.2, 0.25, 0.01, 0, 0]}}))
    expected = [[0.1, 0.01, 0], [0.01, 0.2, 0], [0, 0, 0.25]]
    np.testing.assert_array_equal(robot.model.inertias[3].inertia, expected)
    assert "link fore: inertia replaced by the robot file" in robot.notes[0]
