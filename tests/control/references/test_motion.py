"""References: velocity and acceleration are the exact derivatives, ends are exact and smooth, geodesics are short."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from space_robot_control.references import make_reference
from space_robot_control.references.points import PointToPoint
from space_robot_control.references.profile import quintic
from space_robot_control.references.rows import rows_of
from space_robot_control.references.spline import RestToRestSpline
from space_robot_description import rotations as rot
from space_robot_msgs_py.interfaces import NANOSECONDS, Reference, ReferenceSource, Vector
from tests.support.robots import arm_model, robot_of

N = 3
ROBOT = robot_of(arm_model(N))
KINDS = ("hold", "step", "quintic", "harmonic", "waypoints", "spline")


def random_target(rng: np.random.Generator) -> dict[str, Any]:
    """Some of position, attitude and joints."""
    target: dict[str, Any] = {}
    if rng.random() < 0.8:
        target["position"] = rng.normal(size=3).tolist()
    if rng.random() < 0.5:
        target["attitude_deg"] = rng.uniform(-180, 180, size=3).tolist()
    elif rng.random() < 0.8:
        target["quaternion"] = (7.0 * rng.normal(size=4)).tolist()
    if rng.random() < 0.5:
        target["joints"] = rng.uniform(-2, 2, size=N).tolist()
    else:
        target["joints_deg"] = {"joint_1": rng.uniform(-90, 90)}
    return target


def random_spec(kind: str, rng: np.random.Generator) -> dict[str, Any]:
    """A spec of a kind, with motion between 1 s and 9 s."""
    if kind in ("hold", "step"):
        return {"kind": kind, **random_target(rng), **({"time": 4.0} if kind == "step" else {})}
    if kind == "quintic":
        return {"kind": kind, **random_target(rng), "start": 1.0, "duration": rng.uniform(3.0, 8.0)}
    if kind == "harmonic":
        channels = {name: random_waves(rng, 0.3) for name in ("x", "y", "z", "roll", "pitch", "yaw")}
        joints = {"joint_0": random_waves(rng, 0.5), "joint_2": random_waves(rng, 0.5)}
        return {
            "kind": kind,
            "center": random_target(rng),
            "start": 1.0,
            "soft_start": 3.0,
            "joints": joints,
        } | channels
    times = np.cumsum(rng.uniform(1.0, 2.0, size=4))
    points = [{"time": time, **random_target(rng)} for time in times.tolist()]
    return {"kind": "waypoints", "points": points, "interpolation": "spline" if kind == "spline" else "quintic"}


def random_waves(rng: np.random.Generator, size: float) -> Any:
    """One wave or a sum of two."""
    waves = [
        {"amplitude": rng.normal() * size, "frequency": rng.uniform(0.05, 0.3), "phase_deg": rng.uniform(-180, 180)}
        for _ in range(2)
    ]
    return waves if rng.random() < 0.5 else waves[0]


def random_source(kind: str, seed: int) -> ReferenceSource:
    """A reference of a kind from a random configuration."""
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    start = np.concatenate([rng.normal(size=3), rng.normal(size=4), rng.uniform(-1, 1, size=N)])
    return make_reference(random_spec(kind, rng), ROBOT, start)


def at(source: ReferenceSource, seconds: float) -> Reference:
    """The reference at a time in seconds."""
    return source.at(round(seconds * NANOSECONDS))


def difference(first: Reference, last: Reference, middle: Reference) -> Vector:
    """Change of configuration: position seen from the middle attitude, rotation vector, joints."""
    return np.concatenate(
        [
            rot.rotate_inverse(middle.q[3:7], last.q[:3] - first.q[:3]),
            rot.log(rot.relative(first.q[3:7], last.q[3:7])),
            last.q[7:] - first.q[7:],
        ]
    )


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", KINDS)
def test_velocity_and_acceleration_are_the_derivatives(kind: str, seed: int) -> None:
    """Central differences of q give v and of v give a, for every kind at many times, ends included."""
    source, h = random_source(kind, seed), 1e-4
    for t in [0.5, *np.linspace(1.05, 9.95, 40), 12.0]:
        if kind == "step" and abs(t - 4.0) < 2 * h:
            continue
        before, now, after = at(source, t - h), at(source, t), at(source, t + h)
        np.testing.assert_allclose(difference(before, after, now) / (2 * h), now.v, atol=2e-6, rtol=1e-6)
        np.testing.assert_allclose((after.v - before.v) / (2 * h), now.a, atol=2e-6, rtol=1e-6)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", ["quintic", "harmonic", "waypoints", "spline"])
def test_motion_starts_and_ends_smoothly(kind: str, seed: int) -> None:
    """Configuration, velocity and acceleration never jump: not at the start, between pieces, or at the end."""
    source = random_source(kind, seed)
    times = np.arange(0.0, 11.0, 0.002)
    references = [at(source, t) for t in times]
    for name in ("q", "v", "a"):
        values = np.array([getattr(reference, name) for reference in references])
        steps = np.abs(np.diff(values, axis=0)).max(axis=1)
        # A jump would be a step far above its neighbours; a continuous motion has neighbours of like size.
        around = np.maximum(np.maximum(np.roll(steps, 2), np.roll(steps, -2)), steps.max() / 100)
        assert (steps / around).max() < 3.0, name
    assert not references[0].v.any()
    assert not references[0].a.any()
    if kind != "harmonic":
        assert not references[-1].v.any()
        assert not references[-1].a.any()


@pytest.mark.parametrize("kind", KINDS)
def test_a_reference_is_a_function_of_the_stamp(kind: str) -> None:
    """Asked twice, in any order, by two objects: the same bits, a unit quaternion, and the stamp asked for."""
    first, second = random_source(kind, 9), random_source(kind, 9)
    stamps = [round(t * NANOSECONDS) for t in np.linspace(0, 11, 23)]
    forward = {stamp: first.at(stamp) for stamp in stamps}
    for stamp in reversed(stamps):
        other = second.at(stamp)
        for name in ("q", "v", "a"):
            assert getattr(forward[stamp], name).tobytes() == getattr(other, name).tobytes()
        assert other.stamp == stamp
        assert np.linalg.norm(other.q[3:7]) == pytest.approx(1.0, abs=1e-14)


def start_at(rotation: Any = (0.0, 0.0, 0.0)) -> Vector:
    """Origin, turned, joints at zero."""
    return np.concatenate([np.zeros(3), rot.exp(rotation), np.zeros(N)])


@settings(max_examples=60, deadline=None)
@given(st.tuples(*[st.floats(-4.0, 4.0)] * 6))
def test_quintic_goes_the_short_way_at_constant_axis_and_ends_exactly(turns: tuple[float, ...]) -> None:
    """The attitude sweeps the smaller angle about one fixed axis, in time with the rest, and ends on the target."""
    target = {"position": [1.0, -2.0, 0.5], "quaternion": list(rot.exp(turns[3:])), "joints": [0.5, -0.25, 1.0]}
    first = start_at(turns[:3])
    source = make_reference({"kind": "quintic", "duration": 7.0, **target}, ROBOT, first)
    total = np.array(rot.log(rot.relative(first[3:7], target["quaternion"])))
    assert np.linalg.norm(total) <= np.pi
    for t in (1.0, 3.5, 6.9):
        s = quintic(t / 7.0)[0]
        swept = rot.log(rot.relative(first[3:7], at(source, t).q[3:7]))
        np.testing.assert_allclose(swept, s * total, atol=1e-12)
        np.testing.assert_allclose(at(source, t).q[:3], s * np.array(target["position"]), atol=1e-14)
        np.testing.assert_allclose(at(source, t).q[7:], s * np.array(target["joints"]), atol=1e-14)
    end = at(source, 7.0)
    assert end.q[:3].tolist() == target["position"]
    assert end.q[7:].tolist() == target["joints"]
    assert abs(end.q[3:7] @ np.array(target["quaternion"])) == pytest.approx(1.0, abs=1e-15)
    assert end.q.tobytes() == at(source, 99.0).q.tobytes()
    assert (at(source, 0.0).q[:3] == 0.0).all()


def test_half_a_turn_is_decided_and_stays_decided() -> None:
    """At exactly 180 degrees there is no shorter way; one is chosen, and the sign of the quaternion does not choose."""
    sources = [
        make_reference({"kind": "quintic", "duration": 1.0, "quaternion": [0.0, sign, 0.0, 0.0]}, ROBOT, start_at())
        for sign in (1.0, -1.0)
    ]
    for source in sources:
        assert abs(at(source, 0.5).v[4]) == pytest.approx(1.875 * np.pi, rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_rows_of_a_run_are_those_of_its_stamps(kind: str) -> None:
    """Bit for bit what ``at`` gives, also after a run of the same motion, whatever that one did with its rows."""
    stamps = range(0, 12 * NANOSECONDS, NANOSECONDS // 4)
    for seed in (1, 2, 1):
        source = random_source(kind, seed)
        expected = [source.at(stamp) for stamp in stamps]
        found = rows_of(source, stamps)
        for name, part in zip("qva", found, strict=True):
            assert part.tobytes() == np.array([getattr(one, name) for one in expected]).tobytes()
        for part in found:
            part += 1.0


def test_rows_of_the_same_motion_are_evaluated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A study that runs a motion again does not evaluate it again; other stamps, ends and signs of zero are others."""
    evaluated: list[int] = []

    motion = PointToPoint.motion

    def counted(self: PointToPoint, stamp: int) -> tuple[list[float], list[float], list[float]]:
        evaluated.append(stamp)
        return motion(self, stamp)

    monkeypatch.setattr(PointToPoint, "motion", counted)
    first, second = (np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, angle]) for angle in (0.125, 0.375))
    negative = second * np.array([-1.0, *np.ones(7)])
    for last, ticks, more in ((second, 5, 5), (second, 5, 0), (second, 6, 6), (first, 5, 5), (negative, 5, 5)):
        before = len(evaluated)
        rows_of(PointToPoint(first, last, 0, 10), range(ticks))
        assert len(evaluated) - before == more


def test_step_jumps_at_its_time_and_not_before() -> None:
    """One nanosecond before the time it is the initial configuration, at the time the target."""
    source = make_reference({"kind": "step", "time": 2.0, "joints_deg": [90.0, 0.0, -45.0]}, ROBOT, start_at())
    assert source.at(2 * NANOSECONDS - 1).q[7:].tolist() == [0.0] * N
    np.testing.assert_allclose(source.at(2 * NANOSECONDS).q[7:], [np.pi / 2, 0.0, -np.pi / 4], atol=1e-15)


def test_attitudes_are_roll_pitch_yaw_in_that_order() -> None:
    """attitude_deg means R = Rz(yaw) Ry(pitch) Rx(roll)."""
    source = make_reference({"kind": "hold", "attitude_deg": [90.0, 0.0, 90.0]}, ROBOT, start_at())
    np.testing.assert_allclose(rot.rotate(source.at(0).q[3:7], (0.0, 1.0, 0.0)), [0.0, 0.0, 1.0], atol=1e-15)
    np.testing.assert_allclose(rot.rotate(source.at(0).q[3:7], (1.0, 0.0, 0.0)), [0.0, 1.0, 0.0], atol=1e-15)


def test_harmonic_is_the_bare_wave_after_the_soft_start() -> None:
    """Past the ramp each channel is center + sum of A sin(2 pi f t + phase), in roll, pitch, yaw and joints."""
    waves = [{"amplitude_deg": 5.0, "frequency": 0.1, "phase_deg": 30.0}, {"amplitude": 0.02, "frequency": 0.23}]
    spec = {"kind": "harmonic", "center": {"attitude_deg": [10, -20, 30]}, "soft_start": 4.0, "start": 1.0}
    source = make_reference({**spec, "pitch": waves, "joints": [[], waves[0], []]}, ROBOT, start_at())
    for t in (5.0, 7.7, 31.0):
        expected = np.radians(5.0) * np.sin(2 * np.pi * 0.1 * (t - 1.0) + np.radians(30.0))
        both = expected + 0.02 * np.sin(2 * np.pi * 0.23 * (t - 1.0))
        q = at(source, t).q
        np.testing.assert_allclose(
            rot.to_rpy(q[3:7]), np.radians([10, -20, 30]) + np.array([0.0, both, 0.0]), atol=1e-12
        )
        np.testing.assert_allclose(q[7:], [0.0, expected, 0.0], atol=1e-14)


def test_waypoints_are_met_at_their_times() -> None:
    """Both interpolations pass each configuration; the quintic one rests there, the spline does not."""
    points = [{"time": 2.0 * k, "joints": [0.1 * k * k, 0.2 * k, 0.0], "position": [k, 0, 0]} for k in range(1, 5)]
    for interpolation in ("quintic", "spline"):
        spec = {"kind": "waypoints", "points": points, "interpolation": interpolation}
        source = make_reference(spec, ROBOT, start_at())
        for point in points:
            reference = at(source, point["time"])
            np.testing.assert_allclose(reference.q[7:], point["joints"], atol=1e-13)
            np.testing.assert_allclose(reference.q[:3], point["position"], atol=1e-13)
            inner = point is not points[-1]
            assert reference.v.any() == (inner and interpolation == "spline")


def test_waypoints_inherit_what_they_do_not_say() -> None:
    """A waypoint that names one joint leaves everything else where the one before put it."""
    points = [
        {"time": 0.0, "joints": [0.1, 0.2, 0.3], "attitude_deg": [0, 0, 40]},
        {"time": 1.0, "joints": {"joint_1": 1.0}},
    ]
    source = make_reference({"kind": "waypoints", "points": points}, ROBOT, start_at())
    assert at(source, 0.0).q[7:].tolist() == [0.1, 0.2, 0.3]
    assert at(source, 1.0).q[7:].tolist() == [0.1, 1.0, 0.3]
    np.testing.assert_allclose(rot.to_rpy(at(source, 1.0).q[3:7]), [0, 0, np.radians(40)], atol=1e-14)
    alone = make_reference({"kind": "waypoints", "points": points[:1]}, ROBOT, start_at())
    assert at(alone, 5.0).q[7:].tolist() == [0.1, 0.2, 0.3]


@pytest.mark.parametrize("seed", range(6))
def test_spline_is_smooth_to_the_fourth_derivative_and_knows_its_bounds(seed: int) -> None:
    """Pieces agree in five derivatives at the inner points, and bounds() are what a fine sampling finds."""
    rng = np.random.default_rng(seed)
    times = np.concatenate([[0.0], np.cumsum(rng.uniform(0.5, 3.0, size=5))])
    points = rng.normal(size=(6, 2))
    spline = RestToRestSpline(times, points)
    lowest, highest = spline.bounds()
    samples = np.array([spline.at(t)[0] for t in np.linspace(0.0, times[-1], 4001)])
    assert (samples >= lowest - 1e-12).all()
    assert (samples <= highest + 1e-12).all()
    np.testing.assert_allclose(samples.min(axis=0), lowest, atol=1e-4)
    np.testing.assert_allclose(samples.max(axis=0), highest, atol=1e-4)
    h = 1e-3
    for t, (before, after) in zip(times[1:-1], pairwise(np.diff(times)), strict=True):
        # The second derivative is a cubic on each side; its own first and second derivative have to agree across t.
        left, right = (np.array([spline.at(t + side * k * h)[2] for k in (1, 2, 3, 4)]) for side in (-1.0, 1.0))
        scale = np.abs(points).max() / min(before, after) ** 4
        for order in (1, 2):
            sides = []
            for side, values in ((-1.0, left), (1.0, right)):
                cubic = np.polyfit(side * np.arange(1, 5), values, 3)
                sides.append(cubic[-1 - order])
            np.testing.assert_allclose(sides[0], sides[1], atol=scale * h**3 + 1e-9)
