"""What monitors may read: every value by its name, as NumPy and SciPy have it of the state, reference and command."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from space_robot_description.actuation import command_limit
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Command, Reference, RobotState, Telemetry
from space_robot_supervisor.reader import Reader
from space_robot_supervisor.values import COUNTS, Snapshot, value_of, values_of
from tests.support.robots import arm_model, robot_of

ROBOTS = {name: load_robot(name) for name in ("mini", "servicer")}


def random_snapshot(robot: Robot, seed: int) -> Snapshot:
    """Anything: attitudes of either sign, joints on either side, rates of either sign, a command beyond some limits."""
    rng, n = np.random.default_rng(seed), robot.n
    q, q_d = rng.normal(size=(2, 7 + n))
    for one in (q, q_d):
        one[3:7] /= np.linalg.norm(one[3:7])
    zero = np.zeros(n)
    state = RobotState(7, q, rng.normal(size=6 + n), zero, np.zeros(3))
    limit = command_limit(robot)
    u = np.where(np.isfinite(limit), limit, 1.0) * rng.uniform(-1.5, 1.5, size=6 + n)
    reference = Reference(7, q_d, rng.normal(size=6 + n), np.zeros(6 + n))
    return Snapshot(state, reference, Command(3, u[:6], u[6:]), wheels=rng.normal(size=3))


def formulas(robot: Robot, now: Snapshot) -> dict[str, float]:
    """The same by NumPy and SciPy."""
    q, v, q_d = now.state.q, now.state.v, now.reference.q
    assert now.command is not None
    assert now.wheels is not None
    limit = command_limit(robot)
    bounded = np.isfinite(limit)
    turn = Rotation.from_quat(q[3:7]).inv() * Rotation.from_quat(q_d[3:7])
    found = {
        "base.rate": np.linalg.norm(v[3:6]),
        "base.speed": np.linalg.norm(v[:3]),
        "joints.rate": np.abs(v[6:]).max(),
        "error.position": np.linalg.norm(q_d[:3] - q[:3]),
        "error.attitude": turn.magnitude(),
        "error.joints": np.abs(q_d[7:] - q[7:]).max(),
        "command.saturation": np.mean(np.abs(now.command.u[bounded]) >= limit[bounded]),
    }
    if robot.actuators.base_torque.kind == "reaction_wheels":
        found["wheels.momentum"] = np.linalg.norm(now.wheels)
    margins = np.minimum(q[7:] - robot.joint_lower, robot.joint_upper - q[7:])
    if np.isfinite(margins).any():
        found["joints.margin"] = margins.min()
    parts = {"position": (q[:3], "xyz"), "attitude": (q[3:7], "xyzw"), "joint.position": (q[7:], robot.joint_names)}
    parts |= {"rate": (v[3:6], "xyz"), "joint.rate": (v[6:], robot.joint_names)}
    for part, (numbers, names) in parts.items():
        found |= {f"{part}.{name}": number for name, number in zip(names, numbers, strict=True)}
    return found


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_every_value_is_its_formula(robot: Robot) -> None:
    """There are no others, and in random states each is what its name says."""
    known = values_of(robot)
    reader = Reader(list(known.values()), robot, command_limit(robot))
    for seed in range(20):
        now = random_snapshot(robot, seed)
        reader.read(now)
        read = {name: number for name, (_, number) in zip(known, reader.found, strict=True)}
        assert read == pytest.approx(formulas(robot, now), abs=1e-12)


def test_a_joint_without_limits_has_no_margin() -> None:
    """Of joints with one limit the other side counts nothing; of none there is no such value."""
    lower, upper = np.array([-1.0, -np.inf, -np.inf]), np.array([np.inf, 2.0, np.inf])
    robot = robot_of(arm_model(3), lower=lower, upper=upper)
    some = Reader([values_of(robot)["joints.margin"]], robot, np.full(9, np.inf))

    def margin(*joints: float) -> float | None:
        q = np.array([0, 0, 0, 0, 0, 0, 1.0, *joints])
        zero = np.zeros(9)
        some.read(Snapshot(RobotState(0, q, zero, np.zeros(3), np.zeros(3)), Reference(0, q, zero, zero)))
        return some.found[0][1]

    assert margin(-0.75, 0.0, 9.0) == 0.25
    assert margin(50.0, 1.5, -9.0) == 0.5
    assert margin(0.0, 2.5, 0.0) == -0.5
    free = robot_of(arm_model(3), lower=np.full(3, -np.inf), upper=np.full(3, np.inf))
    assert "joints.margin" not in values_of(free)


def still(telemetry: Telemetry | None = None, **keys: dict[str, int]) -> Snapshot:
    """A robot at rest."""
    robot = ROBOTS["mini"]
    q, v = np.array([0, 0, 0, 0, 0, 0, 1.0, *robot.home]), np.zeros(6 + robot.n)
    state = RobotState(0, q, v, np.zeros(robot.n), np.zeros(3))
    return Snapshot(state, Reference(0, q, v, v), telemetry=telemetry, **keys)


def reader(name: str, labels: tuple[str, ...] = ("a", "b.0", "c"), **keys: bool) -> Callable[[Snapshot], float | None]:
    """A value of ``mini`` with this telemetry."""
    robot = ROBOTS["mini"]
    one = Reader([value_of(name, robot, labels, "key", **keys)], robot, command_limit(robot))

    def read(now: Snapshot) -> float | None:
        one.read(now)
        return one.found[0][1]

    return read


def test_telemetry_is_read_by_label_wherever_it_stands() -> None:
    """A block gives its largest magnitude or one of its numbers, and the same reader follows another layout."""
    first = Telemetry.of(0, {"a": [1.0, -5.0, 2.0], "b.0": [3.0], "c": [-7.0, 4.0]})
    other = Telemetry.of(0, {"c": [1.0], "b.0": [8.0, 9.0], "new": [2.0]})
    empty = Telemetry.of(0, {"a": []})
    assert (reader("telemetry.a")(still(empty)), reader("telemetry.a.0")(still(empty))) == (0.0, None)
    expected: dict[str, tuple[float | None, float | None]] = {
        "telemetry.a": (5.0, None),
        "telemetry.a.1": (-5.0, None),
        "telemetry.b.0": (3.0, 9.0),
        "telemetry.b.0.0": (3.0, 8.0),
        "telemetry.c": (7.0, 1.0),
        "telemetry.c.0": (-7.0, 1.0),
        "telemetry.c.1": (4.0, None),
        "telemetry.c.2": (None, None),
    }
    for name, (one, two) in expected.items():
        read = reader(name)
        assert (read(still()), read(still(first)), read(still(other))) == (None, one, two), name
        assert read(still(first)) == one, name


def test_counts_are_those_of_the_plant() -> None:
    """A count that is not there is 0; before the plant said anything there is none; each is refused where none is."""
    for name in COUNTS:
        read = reader(name, counted=True)
        assert read(still()) is None
        assert read(still(counts={})) == 0.0
        assert read(still(counts={name: 3, "other": 9})) == 3.0
        with pytest.raises(SpecError, match=r"nothing counts it.*plant\.monitor"):
            reader(name)


@pytest.mark.parametrize(
    ("name", "accepted"),
    [
        ("base.rat", "base.rate"),
        ("command.mised", "command.missed"),
        ("telemetry.d", "a, b.0, c"),
        ("telemetry.b.1", "b.0"),
        ("telemetry.a.x", "a"),
        ("nonsense altogether", "telemetry.LABEL"),
    ],
)
def test_a_name_that_is_none_is_refused_with_those_there_are(name: str, accepted: str) -> None:
    """The nearest one, else all of them; with the key that was given, and the name."""
    with pytest.raises(SpecError) as caught:
        reader(name)
    assert (caught.value.key, caught.value.value) == ("key", name)
    assert accepted in str(caught.value.accepted)


def test_a_law_without_telemetry_says_so() -> None:
    """Where there is no label to name; of several the nearest one is named."""
    with pytest.raises(SpecError, match=r"key: no such block of telemetry; got 'telemetry\.eror'; accepted: error$"):
        reader("telemetry.eror", ("gain", "error"))
    with pytest.raises(SpecError, match=r"no such block of telemetry.*accepted: a law with telemetry$"):
        reader("telemetry.a", ())


def test_a_robot_without_joints_has_still_joints() -> None:
    """Their largest rate and error are 0."""
    model = arm_model(0)
    robot = robot_of(model, {"joints": {"effort": 1.0}})
    one = Reader([values_of(robot)[name] for name in ("joints.rate", "error.joints")], robot, command_limit(robot))
    q, v = np.array([0, 0, 0, 0, 0, 0, 1.0]), np.ones(6)
    now = Snapshot(RobotState(0, q, v, np.zeros(0), np.zeros(3)), Reference(0, q, v, v))
    one.read(now)
    assert [number for _, number in one.found] == [0.0, 0.0]
