"""A robot that will make trouble is named before the run: ill-conditioned, frictionless by mistake, or too wide."""

from __future__ import annotations

from typing import Any

import pytest

from space_robot_description.foresight import robot_warnings
from space_robot_description.load import load_robot
from space_robot_description.payload import Payload, attach_payload
from space_robot_description.report import robot_report
from space_robot_description.share import config_dir, shipped
from space_robot_description.validation import parse_yaml
from tests.support.description_texts import TWO_LINKS, actuators, joint, link, robot_file, urdf

LIGHT = '<inertial><mass value="1e-4"/><inertia ixx="1e-7" iyy="1e-7" izz="1e-7"/></inertial>'
DAMPED = '<axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="7" velocity="3"/><dynamics damping="0.3"/>'
ROD = '<inertial><mass value="2"/><inertia ixx="0.02" iyy="{0}" izz="{0}"/></inertial>'
BOX = '<visual><geometry><box size="0.5 0.1 0.1"/></geometry></visual>'


def _warnings(text: str, **changes: Any) -> tuple[str, ...]:
    return robot_warnings(load_robot(robot_file(text, **changes)))


def test_ordinary_robots_are_not_warned_of() -> None:
    """Most shipped robots have nothing to be said of; what is said of the others is known."""
    said = {name: robot_warnings(load_robot(name)) for name in shipped("robots")}
    counts = {name: len(warnings) for name, warnings in said.items() if warnings}
    assert counts == {"ets7": 1, "panda_gripper": 3, "panda_sat": 3, "ur5_sat": 1}


def test_light_links_on_heavy_bases_are_named() -> None:
    """A reduced mass matrix with a condition above 1e5 is a warning with the number, below it is none."""
    light = (*TWO_LINKS[:2], link("fore", LIGHT), *TWO_LINKS[3:])
    (warning,) = _warnings(urdf(*light))
    assert "reduced mass matrix is near singular at home: its condition is" in warning
    assert _warnings(urdf(*TWO_LINKS)) == ()


def test_friction_of_the_urdf_is_named_where_it_is_not_used() -> None:
    """Damping in the URDF is a warning, unless the robot file says what friction there is."""
    text = urdf(*TWO_LINKS[:4], joint("j2", "upper", "fore", inside=DAMPED))
    (warning,) = _warnings(text)
    assert "friction of the URDF are not used (j2 0.3)" in warning
    assert _warnings(text, actuators=actuators(joints={"effort": 5.0, "viscous": 0.1})) == ()


@pytest.mark.parametrize(("moment", "wide"), [(0.1, False), (1.0, True)])
def test_bodies_wider_than_they_are_drawn_are_named(moment: float, wide: bool) -> None:
    """A radius of gyration beyond everything that is drawn of a body is a warning; without a drawing there is none."""
    drawn = urdf(*TWO_LINKS[:2], link("fore", ROD.format(moment) + BOX), *TWO_LINKS[3:])
    warnings = _warnings(drawn)
    assert ["its radius of gyration is" in warning for warning in warnings] == [True] * wide
    assert _warnings(urdf(*TWO_LINKS[:2], link("fore", ROD.format(moment)), *TWO_LINKS[3:])) == ()
    missing = BOX.replace('<box size="0.5 0.1 0.1"/>', '<mesh filename="package://nowhere/a.stl"/>')
    assert _warnings(urdf(*TWO_LINKS[:2], link("fore", ROD.format(moment) + BOX + missing), *TWO_LINKS[3:])) == ()


def test_payloads_are_nothing_that_is_drawn() -> None:
    """A robot that holds something wide is not called wrong."""
    robot = load_robot(robot_file(urdf(*TWO_LINKS[:2], link("fore", ROD.format(0.1) + BOX), *TWO_LINKS[3:])))
    assert robot_warnings(attach_payload(robot, Payload(mass=1.0, inertia=(50.0, 50.0, 50.0)))) == ()


def test_the_wrists_of_the_wheel_would_be_named() -> None:
    """The UR5 of the wheel has wrists of 0.6 m radius, which is seen; the shipped robot replaces them and says so."""
    spec = parse_yaml(config_dir() / "robots" / "ur5_sat.yaml")
    assert len(load_robot("ur5_sat").notes) == 3
    original = load_robot({key: value for key, value in spec.items() if key != "inertia"})
    wide = [warning for warning in robot_warnings(original) if "radius of gyration is 0.424 m" in warning]
    assert [warning.split(":")[0] for warning in wide] == [f"link wrist_{number}_link" for number in (1, 2, 3)]


def test_the_report_carries_notes_and_warnings() -> None:
    """What is printed is in the report, and in its plain form."""
    report = robot_report(load_robot("ur5_sat"))
    assert len(report.notes) == 3
    assert report.to_dict()["warnings"] == list(report.warnings)
