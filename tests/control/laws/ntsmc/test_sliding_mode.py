"""The sliding mode of decoupled DoFs: the paper's closed forms, the adapted gain, the bounds of a held command."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from space_robot_control.laws import make_law
from space_robot_control.laws.ntsmc.gains import SlidingGains
from space_robot_control.laws.ntsmc.kernel.sliding import EQUIVALENT, LOOP_GAIN, REACHING, XI, S
from space_robot_control.laws.ntsmc.sliding_mode import SlidingMode, cycle_rate, loop_gain
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector
from tests.support.robots import arm_model, robot_of

R, RHO = 11 / 9, 7 / 9
numbers = st.floats(-10.0, 10.0)


def sliding(period: float, gamma: float = 0.1, k2: float = 0.1, turning: tuple[int, ...] = (), **gains: Any) -> Any:
    """One DoF."""
    return SlidingMode(SlidingGains(**gains), [gamma], [k2], turning, period)


def terms_of(mode: SlidingMode, e: float, rate: float, e_dot: float, speed_squared: float) -> Vector:
    """The terms of one DoF, (6,)."""
    terms: Vector = mode.terms(np.array([e]), np.array([rate]), np.array([e_dot]), speed_squared)[:, 0]
    return terms


def held(mode: SlidingMode, e: float, v: float, period: float, steps: int) -> tuple[list[float], list[float]]:
    """Errors and rates of a double integrator under a held a2 + a3."""
    errors, rates = [e], [v]
    for _ in range(steps):
        terms = terms_of(mode, e, v, v, v * v)
        mode.adapt(terms[XI : XI + 1].copy(), v * v, saturated=False)
        a = terms[EQUIVALENT] + terms[REACHING]
        e, v = e + period * v + 0.5 * period * period * a, v + period * a
        errors.append(e)
        rates.append(v)
    return errors, rates


@pytest.mark.parametrize(("gamma", "clamp"), [(0.1, False), (0.1, True), (0.4, True)])
@pytest.mark.parametrize("e0", [1.0, -0.3])
def test_an_error_on_the_surface_vanishes_in_the_closed_form_time(gamma: float, clamp: bool, e0: float) -> None:
    """From s = 0 the error follows (11), reaches zero at the time of (12) and stays: to O(T), with the clamp O(T^2)."""
    share = 1.0 / R
    time = abs(e0) ** (1.0 - share) / (gamma**share * (1.0 - share))
    deviations = []
    for period in (0.04, 0.02):
        steps = round(time / period)
        mode = sliding(period, gamma, clamp=clamp)
        errors, _ = held(mode, e0, -np.sign(e0) * (gamma * abs(e0)) ** share, period, steps + round(5 / period))
        left = np.maximum(1.0 - np.arange(steps) * period / time, 0.0)
        exact = e0 * left ** (1.0 / (1.0 - share))
        deviations.append(np.abs(errors[:steps] - exact).max())
        assert np.abs(errors[steps:]).max() < 2e-5
    assert deviations[0] < 2e-4
    assert deviations[0] / deviations[1] == pytest.approx(4.0 if clamp else 2.0, abs=0.05)


@pytest.mark.parametrize("clamp", [False, True])
def test_an_error_off_the_sliding_surface_converges(clamp: bool) -> None:
    """From rest at a distance the error ends within the boundary layer, with and without the clamp."""
    errors, rates = held(sliding(0.02, clamp=clamp), 0.5, 0.0, 0.02, 4000)
    assert abs(errors[-1]) < 1e-6
    assert abs(rates[-1]) < 1e-6


def test_clamp_vanishes_with_the_period() -> None:
    """Clamped and unclamped accelerations agree to first order in T, away from zero rate."""
    gaps = []
    for period in (1e-3, 5e-4):
        both = [terms_of(sliding(period, clamp=clamp), 0.3, -0.05, -0.05, 0.0) for clamp in (False, True)]
        free, bound = (terms[EQUIVALENT] + terms[REACHING] for terms in both)
        gaps.append(abs(free - bound))
    assert gaps[0] < 1e-5
    assert gaps[0] / gaps[1] == pytest.approx(2.0, abs=0.1)


@given(e=numbers, rate=numbers, period=st.floats(0.01, 2.0), k2=st.floats(0.01, 1.0))
def test_no_clamped_command_throws_the_sliding_variable_through_zero(
    e: float, rate: float, period: float, k2: float
) -> None:
    """By the bound of the rate within the period, the reaching term moves s by at most |s|."""
    terms = terms_of(sliding(period, k2=k2, clamp=True), e, rate, rate, 0.0)
    a3, s = abs(terms[REACHING]), abs(terms[S])
    moved = period * R / 0.1 * a3 * (abs(rate) + period * a3) ** (R - 1.0)
    assert moved <= s * (1.0 + 1e-12)


@given(values=st.lists(st.tuples(numbers, numbers), min_size=1, max_size=20))
def test_the_adapted_gain_is_never_negative_and_never_falls_without_a_leak(
    values: list[tuple[float, float]],
) -> None:
    """K_hat only grows as printed; with a leak it decays towards zero, and a cap holds."""
    plain, leaking = sliding(1.0), sliding(1.0, adaptation={"leak": 5.0, "cap": 0.02})
    for e, v in values:
        for mode in (plain, leaking):
            before = mode.estimate[0]
            mode.adapt(terms_of(mode, e, v, v, v * v)[XI : XI + 1].copy(), v * v, saturated=False)
            assert mode.estimate[0] >= 0.0
            if mode is plain:
                assert mode.estimate[0] >= before
    assert leaking.estimate[0] <= 0.02
    leaking.reset()
    assert leaking.estimate[0] == 1e-4


def test_the_adapted_gain_is_frozen_while_saturated_with_the_option() -> None:
    """freeze_on_saturation is the only thing that lets saturation matter to K_hat."""
    for freeze in (False, True):
        mode = sliding(0.1, adaptation={"freeze_on_saturation": freeze})
        mode.adapt(np.ones(1), 0.0, saturated=True)
        assert (mode.estimate[0] == 1e-4) == freeze


@given(e=numbers, rate=numbers, e_dot=numbers, turning=st.booleans(), clamp=st.booleans())
def test_everything_is_finite_and_the_reaching_term_opposes_s(
    e: float, rate: float, e_dot: float, turning: bool, clamp: bool
) -> None:
    """At rest too, where xi/|xi|^2 is 0/0 as printed; a3 never drives s away from zero."""
    mode = sliding(0.1, turning=(0,) if turning else (), clamp=clamp)
    for values in ((e, rate), (e, 0.0), (0.0, 0.0)):
        terms = terms_of(mode, *values, e_dot if turning else values[1], rate * rate)
        assert np.isfinite(terms).all()
        assert terms[REACHING] * terms[S] <= 0.0


def test_loop_gain_is_the_slope_of_the_sampled_map() -> None:
    """At the edge of the layer the gain is -ds/s per period of the reaching term, by finite differences."""
    period, rate = 0.02, 0.05
    mode = sliding(period, adaptation={"initial": 0.02})
    edge, h = 1e-3 - rate**R / 0.1, 1e-9
    inner, outer = (terms_of(mode, edge - x, rate, rate, 0.0)[REACHING] for x in (2 * h, h))
    slope = (inner - outer) / h
    moved = period * R / 0.1 * rate ** (R - 1.0) * slope
    within = loop_gain(period, R, 0.1, rate ** (R - 1.0), 0.02 / 1e-3)
    assert moved == pytest.approx(within, rel=1e-4)
    assert terms_of(mode, edge, rate, rate, 0.0)[LOOP_GAIN] > within


@pytest.mark.parametrize("k2", [0.1, 0.6])
def test_the_reaching_term_cycles_above_the_predicted_period_only(k2: float) -> None:
    """At half of T = 2 g^rho / K2 an error of 1 cm dies out, at 1.1 of it the rate exceeds 1; the clamp ends both."""
    limit = 2.0 * 0.1**RHO / k2
    quiet = {"k1": 0.0, "adaptation": {"initial": 0.0, "rate": 0.0}}
    assert cycle_rate(limit, R, RHO, 0.1, k2) == pytest.approx(1.0)
    for share, clamp in ((0.5, False), (1.1, False), (1.1, True)):
        period = share * limit
        _, rates = held(sliding(period, k2=k2, clamp=clamp, **quiet), 0.01, 0.0, period, 3000)
        cycling = share > 1.0 and not clamp
        assert (np.abs(rates[-50:]).max() > 1.0) == cycling
        assert cycling or np.abs(rates[-50:]).max() < 0.02
    assert cycle_rate(1e9, R, RHO, 0.1, k2) < np.inf
    assert cycle_rate(1.0, R, 0.95, 0.1, k2) == 0.0


def test_table_i_is_cut_and_continued_to_the_arm() -> None:
    """K2 of eight joints is the paper's; four joints have no wrist, nine a longer one; a mapping names the others."""
    for joints, last in ((4, [0.1, 0.1, 0.2, 0.2]), (8, [0.6] * 4), (9, [0.6] * 5)):
        k2 = SlidingGains().k2_of(robot_of(arm_model(joints)))
        assert k2[:8].tolist() == [0.1] * 8
        assert k2[-len(last) :].tolist() == last
    named = SlidingGains.model_validate({"k2": {"joints": {"joint_1": 5.0}}}).k2_of(robot_of(arm_model(4)))
    assert named[6:].tolist() == [0.1, 5.0, 0.2, 0.2]
    assert SlidingGains.model_validate({"k2": 0.3}).k2_of(robot_of(arm_model(4))).tolist() == [0.3] * 10


@pytest.mark.parametrize(
    ("gains", "says"),
    [
        ({"exponents": {"q": 18}}, "exponents.*1 < q/p < 2"),
        ({"exponents": {"p2": 9}}, "exponents.*p2 < q2"),
        ({"adaptation": {"initial": 0.1, "cap": 0.01}}, "initial must not be above cap"),
        ({"gamma": {"rotation": 0.0}}, "gamma.rotation.*greater than 0"),
        ({"gamma": {"joints": [0.1]}}, "gamma.joints: wrong number"),
        ({"saturation": "axes"}, "saturation.*per_axis"),
        ({"disturbance_observer": 1.5}, "disturbance_observer.*less than or equal to 1"),
    ],
)
def test_gains_that_cannot_be_are_refused(gains: dict[str, Any], says: str) -> None:
    """The error names the key and the condition."""
    with pytest.raises(SpecError, match=rf"controller\.gains.*{says}"):
        make_law("ntsmc", robot_of(arm_model(4)), 0.1, gains)
