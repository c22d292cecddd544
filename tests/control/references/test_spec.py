"""What references accept, and the one clear line for everything else."""

from __future__ import annotations

import re
from typing import Any, get_args

import numpy as np
import pytest
from pydantic import TypeAdapter

from space_robot_control.references import Recorded, ReferenceSpec, make_reference
from space_robot_control.references.spec import Wave, Waypoint
from space_robot_msgs_py.errors import CommandError, NonFiniteError, SpaceRobotError, SpecError
from space_robot_msgs_py.interfaces import Reference
from tests.support.paths import ROOT
from tests.support.robots import arm_model, random_state, robot_of

N = 3
LIMIT = np.array([1.0, 3.14159, np.inf])
ROBOT = robot_of(arm_model(N), lower=-LIMIT, upper=LIMIT)
START = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.1, 0.2, 0.3])
NAN = float("nan")

BAD = [
    ({"kind": "quintik"}, "quintic"),
    ({}, "kind"),
    ({"kind": "hold", "joint": [0, 0, 0]}, "joint: unknown key.*joints"),
    ({"kind": "hold", "joints": [0.0, 0.0]}, "reference.joints: wrong number of values"),
    ({"kind": "hold", "joints": {"joint_9": 0.0}}, "reference.joints.*joint_9.*accepted: .*joint_0"),
    ({"kind": "hold", "joints": {"joint_0": 1.2}}, "reference.joints.joint_0: outside .*1.2; accepted: -1 to 1"),
    ({"kind": "hold", "joints_deg": [60.0, 0, 0]}, r"joints_deg.joint_0: outside.*60.*-57.2958 to 57.2958 \[deg\]"),
    ({"kind": "hold", "joints_deg": [0, 0, 0], "joints": [0, 0, 0]}, "joints or joints_deg, not both"),
    ({"kind": "hold", "attitude_deg": [0, 0, 0], "quaternion": [0, 0, 0, 1]}, "attitude_deg or quaternion, not both"),
    ({"kind": "hold", "quaternion": [0, 0, 0, 0]}, "reference.quaternion: not a rotation"),
    ({"kind": "hold", "quaternion": [0, 0, 1]}, "quaternion: not accepted"),
    ({"kind": "hold", "position": [0, NAN, 0]}, "position.1: not accepted.*finite"),
    ({"kind": "hold", "joints": [0, NAN, 0]}, "joints.*finite"),
    ({"kind": "step", "time": -1.0}, "time: not accepted.*greater than or equal to 0"),
    ({"kind": "quintic", "duration": 0.0}, "duration: not accepted.*greater than 0"),
    ({"kind": "quintic"}, "duration: is required"),
    ({"kind": "quintic", "duration": 1e-12}, "reference.duration: too short"),
    ({"kind": "quintic", "duration": float("inf")}, "duration: not accepted.*finite"),
    ({"kind": "harmonic", "roll": {"frequency": 1.0}}, "amplitude or amplitude_deg"),
    ({"kind": "harmonic", "roll": {"amplitude": 1.0, "amplitude_deg": 1.0, "frequency": 1.0}}, "one of them"),
    ({"kind": "harmonic", "roll": {"amplitude": 1.0, "frequency": -1.0}}, "frequency: not accepted"),
    ({"kind": "harmonic", "x": {"amplitude_deg": 1.0, "frequency": 1.0}}, "reference.x: an amplitude in degrees"),
    ({"kind": "harmonic", "joints": {"joint_5": {"amplitude": 1, "frequency": 1}}}, "no such joint.*joint_5"),
    ({"kind": "harmonic", "joints": [[], []]}, "reference.joints: wrong number of entries"),
    ({"kind": "harmonic", "joints": {"joint_0": {"amplitude": 0.95, "frequency": 1}}}, "joint_0: outside .*1.05"),
    ({"kind": "harmonic", "soft_start": 0.0}, "soft_start: not accepted"),
    ({"kind": "waypoints", "points": []}, "points: not accepted"),
    ({"kind": "waypoints", "points": [{"time": 2.0}, {"time": 2.0}]}, r"points.1.time: not later .*more than 2 \[s\]"),
    ({"kind": "waypoints", "points": [{"time": 2.0, "joints": [0.0]}]}, "points.0.joints: wrong number"),
    ({"kind": "recorded", "stamps": [0], "q": [[0, 0]], "v": [[]], "a": [[]]}, "q.0: wrong number of columns"),
    ({"kind": "recorded", "stamps": [0, 1], "q": [START.tolist()], "v": [], "a": []}, "q: wrong number of rows"),
]


@pytest.mark.parametrize(("spec", "says"), BAD)
def test_a_bad_reference_is_one_clear_error(spec: dict[str, Any], says: str) -> None:
    """The message is one line with the dotted key, the value and what would be accepted."""
    with pytest.raises(SpecError, match=rf"reference.*{says}|{says}") as caught:
        make_reference(spec, ROBOT, START)
    assert "\n" not in str(caught.value)


def test_spline_that_overshoots_a_limit_between_waypoints_is_refused() -> None:
    """Waypoints inside the limits are not enough: the curve between them has to stay inside too."""
    joints = ([0.0, 0, 0], [0.99, 0, 0], [0.99, 0, 0], [0.0, 0, 0])
    points = [{"time": 2.0 * k, "joints": q} for k, q in enumerate(joints)]
    spec = {"kind": "waypoints", "points": points}
    make_reference(spec, ROBOT, START)
    with pytest.raises(SpecError, match=r"spline between the waypoints.*joint_0: outside the joint's limits"):
        make_reference({**spec, "interpolation": "spline"}, ROBOT, START)


def test_joints_move_by_an_angle_from_where_the_motion_before_ended() -> None:
    """joints_by_deg adds to the previous configuration: one number for all, a list, or a mapping that leaves others."""
    points = [{"time": 1.0, "joints_by_deg": 10.0}, {"time": 2.0, "joints_by_deg": {"joint_1": -5.0}}]
    source = make_reference({"kind": "waypoints", "points": points}, ROBOT, START)
    np.testing.assert_allclose(source.at(1_000_000_000).q[7:], START[7:] + np.radians(10.0), atol=1e-15)
    np.testing.assert_allclose(source.at(2_000_000_000).q[7:], START[7:] + np.radians([10, 5, 10]), atol=1e-15)
    with pytest.raises(SpecError, match=r"joints_by_deg.joint_0: outside .* got 65\.7"):
        make_reference({"kind": "hold", "joints_by_deg": 60.0}, ROBOT, START)


def test_documentation_names_every_kind_and_key() -> None:
    """docs/laws.md mentions each kind of reference and each of its keys."""
    text = (ROOT / "docs" / "laws.md").read_text(encoding="utf-8")
    text = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    models = [*get_args(get_args(ReferenceSpec)[0]), Waypoint, Wave]
    words = set(re.findall(r"\w+", " ".join(re.findall(r"`([^`]+)`", text))))
    for model in models:
        for name, field in model.model_fields.items():
            assert (field.default if name == "kind" else name) in words


def test_a_limit_rounded_in_the_file_admits_the_full_angle() -> None:
    """180 degrees fit a limit written as 3.14159, and an unlimited joint takes any angle."""
    source = make_reference({"kind": "hold", "joints_deg": [0.0, 180.0, 720.0]}, ROBOT, START)
    np.testing.assert_allclose(source.at(0).q[7:], [0.0, np.pi, 4 * np.pi], atol=1e-15)


def test_initial_joints_outside_the_limits_can_be_held_but_not_desired() -> None:
    """Limits are checked on targets; where the robot happens to be is not the reference's to judge."""
    outside = START.copy()
    outside[7] = 1.3
    assert make_reference({"kind": "hold"}, ROBOT, outside).at(0).q[7] == 1.3
    with pytest.raises(SpecError, match="joint_0"):
        make_reference({"kind": "hold", "joints": {"joint_0": 1.3}}, ROBOT, outside)


@pytest.mark.parametrize(
    ("start", "error"),
    [
        (START[:-1], CommandError),
        (np.full(7 + N, NAN), NonFiniteError),
        (np.zeros(7 + N), SpecError),
    ],
)
def test_a_start_that_is_no_configuration_is_refused(start: np.ndarray, error: type[SpaceRobotError]) -> None:
    """Size, finiteness and quaternion of the initial configuration are checked; its length is not: it is scaled."""
    with pytest.raises(error):
        make_reference({"kind": "hold"}, ROBOT, start)
    scaled = START.copy()
    scaled[6] = 3.0
    assert make_reference({"kind": "hold"}, ROBOT, scaled).at(0).q[6] == 1.0


def test_specs_survive_being_written_and_read() -> None:
    """A spec dumped with all defaults and read again is the same spec: the resolved experiment runs the same."""
    wave = {"amplitude_deg": 3.0, "frequency": 0.1}
    adapter: TypeAdapter[Any] = TypeAdapter(ReferenceSpec)
    for raw in (
        {"kind": "hold"},
        {"kind": "step", "time": 1.0, "joints_deg": {"joint_0": 3.0}},
        {"kind": "quintic", "duration": 3.0, "quaternion": [0, 0, 0, 2]},
        {"kind": "harmonic", "roll": wave, "pitch": [wave, wave], "joints": {"joint_0": [], "joint_1": wave}},
        {"kind": "waypoints", "points": [{"time": 1.0, "joints": [0, 0, 0]}], "interpolation": "spline"},
    ):
        spec = adapter.validate_python(raw)
        again = adapter.validate_python(adapter.dump_python(spec, mode="json"))
        assert again == spec
        one, two = (make_reference(s, ROBOT, START).at(2_345_678_901) for s in (spec, again))
        assert one.q.tobytes() == two.q.tobytes()
        assert one.a.tobytes() == two.a.tobytes()


def records(count: int = 4, period: int = 100_000_000) -> list[Reference]:
    """Some references."""
    rng = np.random.default_rng(7)
    rows = []
    for k in range(count):
        q, v = random_state(rng, N)
        rows.append(Reference(k * period, q, v, rng.normal(size=6 + N)))
    return rows


def test_recorded_gives_back_what_was_recorded() -> None:
    """Exact stamps give the recorded bits, from values, arrays and files alike."""
    given = records()
    arrays = {name: [getattr(r, name).tolist() for r in given] for name in ("q", "v", "a")}
    stamps = [r.stamp for r in given]
    sources = (
        Recorded(given),
        Recorded.from_arrays(stamps, **arrays),
        make_reference({"kind": "recorded", "stamps": stamps, **arrays}, ROBOT, START),
    )
    for source in sources:
        for reference in given:
            found = source.at(reference.stamp)
            assert found.stamp == reference.stamp
            for name in ("q", "v", "a"):
                assert getattr(found, name).tobytes() == getattr(reference, name).tobytes()


def test_recorded_rests_after_its_end_and_knows_nothing_in_between() -> None:
    """After the last stamp the last configuration is held at rest; between and before stamps there is an error."""
    given = records()
    source = Recorded(given[1:])
    late = source.at(given[-1].stamp + 1)
    assert late.q.tobytes() == given[-1].q.tobytes()
    assert not late.v.any()
    assert not late.a.any()
    for stamp in (0, 150_000_000):
        with pytest.raises(SpecError, match=rf"stamp: no reference recorded; got {stamp}; accepted: e.g. \d00000000"):
            source.at(stamp)


def test_recordings_that_are_none_are_refused() -> None:
    """No rows, stamps that do not increase, and robots of different size are errors."""
    given = records()
    with pytest.raises(SpecError, match="no reference"):
        Recorded([])
    with pytest.raises(SpecError, match="stamps do not increase"):
        Recorded([given[1], given[0]])
    q, v = random_state(np.random.default_rng(0), N + 1)
    with pytest.raises(SpecError, match="different sizes"):
        Recorded([given[0], Reference(10, q, v, v)])
