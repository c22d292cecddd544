"""The model-free law without a robot: dead-beat, convergence, limits, distorted samples, initial value."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.gated_filter import GatedFilter
from space_robot_control.laws.mfac.incremental_controller import IncrementalController, Weights, weights_of
from space_robot_control.laws.mfac.initial_value import ResponseFit
from space_robot_control.laws.mfac.pseudo_gradient import PseudoGradient
from space_robot_msgs_py.errors import ControlError, SpecError
from space_robot_msgs_py.interfaces import Vector


class LinearPlant:
    """A plant of exactly the form dy(k+1) = Phi [dy(k) .. du(k) ..]."""

    def __init__(self, phi: Vector, ly: int, lu: int) -> None:
        self.m = phi.shape[0]
        self._phi, self.y, self._u = phi, np.zeros(self.m), np.zeros(self.m)
        self._dy, self._du = [np.zeros(self.m)] * ly, [np.zeros(self.m)] * lu
        self.dy = np.zeros(self.m)

    def step(self, u: Vector) -> None:
        self._du = [u - self._u, *self._du[:-1]]
        self._u = u
        self.dy = self._phi @ np.concatenate([*self._dy, *self._du])
        self._dy = [self.dy, *self._dy[:-1]]
        self.y = self.y + self.dy


def random_gradient(rng: np.random.Generator, m: int, ly: int, lu: int) -> Vector:
    """A plant whose past fades and whose input has an inverse."""
    past = [0.3 * rng.normal(size=(m, m)) / m for _ in range(ly)]
    inputs = [np.eye(m) + 0.2 * rng.normal(size=(m, m)), *(0.2 * rng.normal(size=(m, m)) for _ in range(lu - 1))]
    return np.hstack([*past, *inputs])


@pytest.mark.parametrize(("m", "ly", "lu"), [(1, 2, 1), (1, 1, 1), (1, 2, 3), (3, 2, 1), (3, 3, 2)])
def test_without_lambda_the_law_is_dead_beat_in_one_step(m: int, ly: int, lu: int) -> None:
    """With exact Phi, rho = 1 and lambda = 0 every output is at its target one period after it was asked."""
    rng = np.random.default_rng(1)
    phi = random_gradient(rng, m, ly, lu)
    plant, gradient = LinearPlant(phi, ly, lu), PseudoGradient(phi, ly, lu, sigma=0.0, beta=1.0)
    law = IncrementalController(weights_of(ly, lu, 1.0, 0.0, 0.0), ly, lu, np.full(m, np.inf))
    for _ in range(10):
        target = rng.normal(size=m)
        plant.step(law.update(target - plant.y, plant.dy, gradient))
        np.testing.assert_allclose(plant.y, target, rtol=0.0, atol=1e-11)


def test_lambda_shares_out_the_step() -> None:
    """With lambda = kappa phi^2 the first step goes 1 / (1 + kappa) of the way, whatever the units of the input."""
    for gain in (1e-4, 1.0, 1e3):
        phi = np.array([[0.0, 0.0, gain]])
        plant, gradient = LinearPlant(phi, 2, 1), PseudoGradient(phi, 2, 1, sigma=0.0, beta=1.0)
        law = IncrementalController(weights_of(2, 1, 1.0, 4.0, 0.0), 2, 1, np.array([np.inf]))
        plant.step(law.update(np.array([1.0]), plant.dy, gradient))
        assert plant.y[0] == pytest.approx(0.2, rel=1e-12)
        same = IncrementalController(weights_of(2, 1, 1.0, 0.0, 4.0 * gain**2), 2, 1, np.array([np.inf]))
        np.testing.assert_allclose(same.update(np.array([1.0]), np.zeros(1), gradient), law.command, rtol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3])
def test_lambda_has_a_floor_where_phi_is_nearly_singular(angle: float) -> None:
    """Across the only direction in which the outputs still answer, the input is at most error / least gain."""
    first = np.hstack([np.zeros((2, 4)), np.eye(2)])
    gradient = PseudoGradient(first, 2, 1, sigma=0.0, beta=1.0, floor=0.1)
    gradient.estimate[:, 4:] = [[1.0, 1.0], [1.0, 1.0 + angle]]
    law = IncrementalController(weights_of(2, 1, 1.0, 0.0, 0.0), 2, 1, np.full(2, np.inf))
    across = law.update(np.array([1.0, -1.0]) / np.sqrt(2.0), np.zeros(2), gradient)
    assert np.linalg.norm(across) <= 1.0 / gradient.least_gain
    law.reset()
    along = law.update(np.array([1.0, 1.0]), np.zeros(2), gradient)
    np.testing.assert_allclose(gradient.block(2) @ along, [1.0, 1.0], rtol=0.01)


@pytest.mark.parametrize(("m", "ly", "lu"), [(1, 2, 1), (3, 2, 1), (2, 1, 2)])
def test_the_estimate_converges_under_persistent_excitation(m: int, ly: int, lu: int) -> None:
    """Driven by white noise, the estimate reaches the plant's Phi from a wrong one and the innovation vanishes."""
    rng = np.random.default_rng(2)
    phi = random_gradient(rng, m, ly, lu)
    plant = LinearPlant(phi, ly, lu)
    first = phi.copy()
    first[:, m * ly : m * (ly + 1)] *= 2.0
    gradient = PseudoGradient(first, ly, lu, sigma=1.0, beta=0.01)
    u = np.zeros(m)
    for _ in range(30_000):
        new = u + rng.normal(size=m)
        plant.step(new)
        gradient.update(plant.dy, new - u)
        u = new
    assert np.abs(gradient.estimate - phi).max() < 1e-6
    assert np.abs(gradient.innovation).max() < 1e-6
    assert gradient.resets == 0


def test_an_estimate_that_changes_sign_or_fades_starts_again() -> None:
    """Data of a plant that pushes the other way resets the estimate instead of turning the loop around."""
    gradient = PseudoGradient(np.array([[1.0, 0.0, 1.0]]), 2, 1, sigma=1.0, beta=0.1)
    rng = np.random.default_rng(3)
    for _ in range(200):
        du = rng.normal(size=1)
        gradient.update(-2.0 * du, du)
        assert gradient.block(2)[0, 0] >= 0.1
    assert gradient.resets > 0


def test_a_frozen_estimate_stays() -> None:
    """With sigma = 0 nothing is learned, and the innovation still shows how wrong the model is."""
    first = np.array([[1.0, 0.0, 1.0]])
    gradient = PseudoGradient(first, 2, 1, sigma=0.0, beta=1.0)
    gradient.update(np.array([3.0]), np.array([1.0]))
    assert (gradient.estimate == first).all()
    assert gradient.innovation[0] == 2.0


def test_a_full_matrix_of_independent_channels_is_the_channels() -> None:
    """The matrix law on a diagonal Phi gives, channel by channel, what the one-channel law gives."""
    gains, rng = np.array([0.5, 2.0, 7.0]), np.random.default_rng(4)
    weights, limit = weights_of(2, 1, 0.3, 3.0, 0.0), np.array([0.4, 1.0, 0.2])
    first = np.hstack([np.eye(3), np.zeros((3, 3)), np.diag(gains)])
    joint = IncrementalController(weights, 2, 1, limit)
    matrix = PseudoGradient(first, 2, 1, sigma=0.0, beta=1.0)
    single = [IncrementalController(weights, 2, 1, limit[i : i + 1]) for i in range(3)]
    rows = [PseudoGradient(np.array([[1.0, 0.0, gain]]), 2, 1, sigma=0.0, beta=1.0) for gain in gains]
    for _ in range(50):
        error, dy = rng.normal(size=3), rng.normal(size=3)
        together = joint.update(error, dy, matrix)
        apart = [single[i].update(error[i : i + 1], dy[i : i + 1], rows[i])[0] for i in range(3)]
        np.testing.assert_allclose(together, apart, rtol=1e-12, atol=1e-14)


def test_the_limit_freezes_the_integral_and_keeps_the_proportional_part() -> None:
    """After a long time at the limit the command leaves it as soon as the proportional part says so."""
    gradient = PseudoGradient(np.array([[1.0, 0.0, 1.0]]), 2, 1, sigma=0.0, beta=1.0)
    law = IncrementalController(weights_of(2, 1, 0.1, 0.0, 0.0), 2, 1, np.array([1.0]))
    law.update(np.array([5.0]), np.array([-5.0]), gradient)
    for _ in range(100):
        assert law.update(np.array([5.0]), np.zeros(1), gradient)[0] == 1.0
        assert law.saturated[0]
    assert law.update(np.array([0.5]), np.array([4.5]), gradient)[0] < 1.0
    assert law.update(np.array([-1.0]), np.array([1.5]), gradient)[0] < 0.0


def test_a_channel_without_effect_is_an_error() -> None:
    """Neither an initial Phi without inverse nor a number that is not finite gets through."""
    with pytest.raises(SpecError, match="no inverse"):
        PseudoGradient(np.array([[1.0, 0.0, 0.0]]), 2, 1, sigma=1.0, beta=1.0)
    with pytest.raises(SpecError, match="Ly"):
        IncrementalController(Weights((1.0,)), 2, 1, np.array([1.0]))
    gradient = PseudoGradient(np.array([[1.0, 0.0, 1.0]]), 2, 1, sigma=0.0, beta=1.0)
    law = IncrementalController(weights_of(2, 1, 1.0, 1.0, 0.0), 2, 1, np.array([1.0]))
    with pytest.raises(ControlError, match="finite"):
        law.update(np.array([np.nan]), np.zeros(1), gradient)


def test_the_filter_follows_a_ramp_without_lag() -> None:
    """Value and rate of a constant rate are exact in the end; no good sample is refused."""
    measured = GatedFilter(0.1, 3.0, np.array([0.5]), 5)
    for k in range(200):
        measured.update(np.array([2.0 + 0.1 * k * 0.7]))
    assert measured.value[0] == pytest.approx(2.0 + 19.9 * 0.7, abs=1e-9)
    assert measured.rate[0] == pytest.approx(0.7, abs=1e-9)
    assert measured.refused[0] == 0


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e3])
def test_a_bad_sample_is_replaced_by_the_prediction(bad: float) -> None:
    """A sample that is not finite or far off changes nothing but the count; the ramp goes on."""
    measured = GatedFilter(0.1, 3.0, np.array([0.5]), 5)
    for k in range(100):
        measured.update(np.array([bad if k % 7 == 3 else 0.07 * k]))
        assert measured.missing[0] == (k % 7 == 3)
    assert measured.value[0] == pytest.approx(0.07 * 99, abs=1e-6)
    assert measured.refused[0] == 14


def test_a_filter_that_is_wrong_gives_in() -> None:
    """After ``patience`` refusals in a row the samples are believed again."""
    measured = GatedFilter(0.1, 3.0, np.array([0.5]), 5)
    measured.update(np.array([0.0]))
    for _ in range(6):
        measured.update(np.array([10.0]))
    assert measured.value[0] == 10.0
    assert measured.rate[0] == 0.0


def test_a_known_jump_is_no_outlier() -> None:
    """A jump that was announced passes the gate and moves no rate."""
    measured = GatedFilter(0.1, 3.0, np.array([0.5]), 5)
    measured.update(np.array([0.0]))
    measured.update(np.array([10.0]), np.array([10.0]))
    assert measured.value[0] == 10.0
    assert measured.refused[0] == 0


@pytest.mark.parametrize("diagonal", [True, False])
def test_the_initial_value_is_exact_without_noise(diagonal: bool) -> None:
    """B of a double integrator comes out of its motion whatever the unknown start, its deviation with it."""
    gain = np.diag([0.3, 2.0]) if diagonal else np.array([[0.3, -0.1], [0.4, 2.0]])
    fit, rng, period = ResponseFit(0.1, 2, diagonal=diagonal), np.random.default_rng(5), 0.1
    y, v = rng.normal(size=2), rng.normal(size=2)
    for _ in range(40):
        u = rng.normal(size=2)
        fit.add(y, u)
        y, v = y + period * v + 0.5 * period**2 * gain @ u, v + period * gain @ u
    found = fit.solve()
    np.testing.assert_allclose(found.gain, gain, atol=1e-10)
    assert found.deviation.max() < 1e-9


def test_the_deviation_of_the_initial_value_is_honest() -> None:
    """Over many noisy pushes the error of B is distributed as its stated deviation says; one sample says nothing."""
    rng, period, push, noise = np.random.default_rng(6), 0.1, 0.1, 3.5e-4
    scores, relative = [], []
    for _ in range(300):
        fit = ResponseFit(period, 1, diagonal=True)
        for k in range(51):
            y = 0.5 * (k * period) ** 2 * push / 160.6
            fit.add(np.array([y + noise * rng.normal()]), np.array([push]))
        found = fit.solve()
        scores.append((found.gain[0, 0] - 1.0 / 160.6) / found.deviation[0, 0])
        relative.append(found.relative[0])
    assert 0.85 < np.std(scores) < 1.15
    assert abs(np.mean(scores)) < 0.2
    assert np.median(relative) < 0.1
    short = ResponseFit(period, 1, diagonal=True)
    short.add(np.zeros(1), np.array([push]))
    short.add(np.array([1e-4]), np.array([push]))
    assert short.solve().relative[0] == np.inf
