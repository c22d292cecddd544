"""A robot weighs what its URDF says, however it is spelt; nothing is dropped, and nothing is printed."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from space_robot_description import link_body, sums
from space_robot_description.inertia import inertial_parameters
from space_robot_description.load import load_robot
from space_robot_description.share import shipped
from space_robot_description.urdf import parse_urdf
from space_robot_msgs_py.errors import InertiaError, SpecError
from tests.support.description_texts import BOX, TWO_LINKS, joint, link, robot_file, urdf
from tests.support.urdf_reader import inverse_dynamics, read_links
from tests.support.urdf_spelling import spelt_robot

FULL = BOX.replace("<mass", '<origin xyz="0.1 0.2 0.3" rpy="0 0 0"/><mass')
SPELLINGS = {
    "blank behind the mass": FULL.replace('value="2"', 'value="2 "'),
    "blanks around ixx": FULL.replace('ixx="0.02"', 'ixx=" 0.02 "'),
    "newline in xyz": FULL.replace("0.1 0.2 0.3", "0.1\n0.2\t0.3"),
    "newline behind xyz": FULL.replace("0.1 0.2 0.3", "0.1 0.2 0.3\n"),
    "no products of inertia": FULL.replace(' ixz="0" iyz="0"', ""),
    "no rpy": FULL.replace(' rpy="0 0 0"', ""),
    "exponents": FULL.replace('ixx="0.02"', 'ixx="+2E-2"').replace('"0.03"', '"3.e-2"').replace('"0.04"', '".04"'),
}


@pytest.mark.parametrize("case", SPELLINGS)
def test_spelling_of_a_fixed_link_changes_no_number(case: str, capfd: pytest.CaptureFixture[str]) -> None:
    """A link that is fixed to another weighs the same however its numbers are written, and nothing is printed."""
    parts = [*TWO_LINKS, joint("weld", "fore", "tip", "fixed")]
    expected = load_robot(robot_file(urdf(*parts, link("tip", FULL))))
    robot = load_robot(robot_file(urdf(*parts, link("tip", SPELLINGS[case]))))
    assert inertial_parameters(robot).tobytes() == inertial_parameters(expected).tobytes()
    assert capfd.readouterr() == ("", "")


@given(seed=st.integers(0, 10**6))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_any_legal_spelling_is_read_as_by_another_reader(seed: int) -> None:
    """Mass, inertia and forward dynamics of random URDFs are those of a reader that shares no line with this one."""
    text = spelt_robot(seed)
    links, robot = read_links(text), load_robot(robot_file(text))
    assert sum(i.mass for i in robot.model.inertias) == pytest.approx(
        sum(part.mass for part in links.values()), rel=1e-14
    )
    rng, n = np.random.default_rng(seed), robot.n
    joints, rates, efforts = rng.uniform(-1, 1, n), rng.uniform(-1, 1, 6 + n), rng.uniform(-1, 1, 6 + n)
    q = np.concatenate([pin.neutral(robot.model)[:7], joints])
    acceleration = pin.aba(robot.model, robot.model.createData(), q, rates, efforts)
    names = robot.joint_names
    motion = [{"": row[:6]} | dict(zip(names, row[6:], strict=True)) for row in (rates, acceleration)]
    needed = inverse_dynamics(links, "l0", dict(zip(names, joints, strict=True)), *motion)
    found = np.concatenate([needed[""], [needed[name] for name in names]])
    np.testing.assert_allclose(found, efforts, atol=1e-11 * (1.0 + np.max(np.abs(acceleration))))


@given(seed=st.integers(0, 10**6))
@settings(max_examples=15, deadline=None, derandomize=True)
def test_composed_urdf_is_read_alike_by_urdfdom(seed: int) -> None:
    """What goes on ``robot_description`` is spelt so that the strictest reader finds the same robot in it."""
    robot = load_robot(robot_file(spelt_robot(seed)))
    other = pin.buildModelFromXML(robot.urdf, pin.JointModelFreeFlyer())
    order = [robot.model.getJointId(name) for name in other.names]
    assert sorted(order) == list(range(robot.n + 2))
    for index, own in enumerate(order):
        expected = robot.model.inertias[own].toDynamicParameters()
        scale = 1.0 + np.max(np.abs(expected))
        np.testing.assert_allclose(other.inertias[index].toDynamicParameters(), expected, atol=1e-12 * scale)


@pytest.mark.parametrize("name", shipped("robots"))
def test_a_successful_load_prints_nothing(name: str, capfd: pytest.CaptureFixture[str]) -> None:
    """Neither Python nor the libraries in C++ say anything where a robot is loaded."""
    load_robot(name)
    assert capfd.readouterr() == ("", "")


def test_quaternion_of_urdf_1_1_turns_the_joint() -> None:
    """``quat_xyzw`` places a joint as the ``rpy`` of the same rotation does."""
    turned = joint("j2", "upper", "fore").replace('rpy="0.1 0 0"', 'quat_xyzw="0 0 2 2"')
    first = load_robot(robot_file(urdf(*TWO_LINKS[:4], turned).replace("<robot", '<robot version="1.1"')))
    angle = joint("j2", "upper", "fore").replace('rpy="0.1 0 0"', f'rpy="0 0 {np.pi / 2}"')
    second = load_robot(robot_file(urdf(*TWO_LINKS[:4], angle)))
    np.testing.assert_allclose(
        first.model.jointPlacements[3].homogeneous, second.model.jointPlacements[3].homogeneous, atol=1e-15
    )
    assert "quat_xyzw" not in first.urdf


BAD_ORIGINS = {
    "old version": (
        'quat_xyzw="0 0 0 1"',
        "1.0",
        "quat_xyzw is none of URDF 1.0; got '0 0 0 1'; accepted: rpy, or <robot",
    ),
    "two rotations": ('rpy="0 0 0" quat_xyzw="0 0 0 1"', "1.1", "<origin> has two rotations"),
    "no direction": ('quat_xyzw="0 0 0 0"', "1.1", "not a rotation"),
    "three numbers": (
        'quat_xyzw="0 0 1"',
        "1.1",
        "quat_xyzw is not a vector; got '0 0 1'; accepted: four finite numbers",
    ),
    "strange": ('quat="0 0 0 1"', "1.1", "<origin> has an attribute that is none of URDF; got 'quat'"),
    "version": ('rpy="0 0 0"', "2.0", "unknown version of URDF; got '2.0'"),
}


@pytest.mark.parametrize("case", BAD_ORIGINS)
def test_rotations_that_are_not_used_are_refused(case: str) -> None:
    """A rotation that is given in a way this version does not have is refused by joint, attribute and value."""
    attributes, version, message = BAD_ORIGINS[case]
    bad = joint("j2", "upper", "fore").replace('rpy="0.1 0 0"', attributes)
    with pytest.raises(SpecError) as error:
        load_robot(robot_file(urdf(*TWO_LINKS[:4], bad).replace("<robot", f'<robot version="{version}"')))
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_a_model_that_differs_from_its_links_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The sums over the links are computed apart from the model: a link that is lost on the way is noticed."""
    monkeypatch.setattr(link_body.LinkBody, "spatial", lambda self: pin.Inertia(self.mass, self.com, 2 * self.inertia))
    with pytest.raises(InertiaError, match="link base_link: the model differs from the sum over the links"):
        load_robot(robot_file())
    monkeypatch.undo()
    robot = load_robot(robot_file())
    tree = parse_urdf(robot.urdf, "urdf")
    bodies = {name: link_body.read_body(name, element) for name, element in tree.links.items()}
    sums.check_sums(tree, bodies, robot.model)
    with pytest.raises(InertiaError, match="link fore"):
        sums.check_sums(tree, bodies | {"fore": link_body.NO_BODY}, robot.model)


@pytest.mark.parametrize("name", ["universe", "root_joint", "upper"])
def test_joints_and_links_may_have_any_name(name: str) -> None:
    """Names that Pinocchio uses itself, and a joint that is called as a link, are names like others."""
    robot = load_robot(robot_file(urdf(*TWO_LINKS[:4], joint(name, "upper", "fore"))))
    assert robot.joint_names == ("j1", name)
    expected = inertial_parameters(load_robot(robot_file()))
    np.testing.assert_array_equal(inertial_parameters(robot), expected)
