"""The stability map: the border of the map is the border of the simulated loop."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.laws.mfac.incremental_controller import IncrementalController, weights_of
from space_robot_control.laws.mfac.pseudo_gradient import PseudoGradient
from space_robot_control.laws.mfac.stability import spectral_radius, stability_map


def peaks(ratio: float, rho: float, delay: int, lead: float | None, periods: int) -> tuple[float, float]:
    """Largest |[y, T y']| in the first and the last twentieth of a run of the law, its commands held."""
    phi = [2.0, -1.0, 1.0] if lead is None else [1.0, 0.0, lead + 0.5]
    gradient = PseudoGradient(np.array([phi]), 2, 1, sigma=0.0, beta=1.0)
    law = IncrementalController(weights_of(2, 1, rho, 1.0 / ratio, 0.0), 2, 1, np.array([np.inf]))
    y, v, before, waiting, sizes = 1.0, 0.0, 1.0, 0.0, []
    for _ in range(periods):
        out = y + (lead or 0.0) * v
        u = float(law.update(np.array([-out]), np.array([out - before]), gradient)[0])
        before, acting, waiting = out, waiting if delay else u, u
        y, v = y + v + 0.5 * acting, v + acting
        sizes.append(float(np.hypot(y, v)))
    share = periods // 20
    return max(sizes[:share]), max(sizes[-share:])


def points() -> list[tuple[float, float, int, float | None]]:
    """50 points of the map at which a loop grows or decays by a thousandth per period or more."""
    rng = np.random.default_rng(7)
    found: list[tuple[float, float, int, float | None]] = []
    while len(found) < 50:
        index = len(found)
        ratio, rho = 10.0 ** rng.uniform(-2, 1.5), 10.0 ** rng.uniform(-3, 0)
        delay, lead = index % 2, (None, 20.0, 3.0)[index % 3]
        if abs(spectral_radius(ratio, rho, delay, lead=lead) - 1.0) > 1e-3:
            found.append((ratio, rho, delay, lead))
    return found


@pytest.mark.parametrize(("ratio", "rho", "delay", "lead"), points())
def test_the_map_agrees_with_the_simulated_loop(ratio: float, rho: float, delay: int, lead: float | None) -> None:
    """At 50 points the law on a plant with held commands decays or grows as the spectral radius says."""
    radius = spectral_radius(ratio, rho, delay, lead=lead)
    first, last = peaks(ratio, rho, delay, lead, periods=max(200, round(10.0 / abs(np.log(radius)))))
    assert (last < 0.05 * first) == (radius < 1.0)
    assert (last > 20.0 * first) == (radius > 1.0)


def test_the_difference_equation_of_the_paper_is_stable_where_phi_squared_over_lambda_exceeds_rho() -> None:
    """On the Euler plant the border is phi^2 / lambda = rho."""
    for ratio in (0.01, 0.1, 0.5, 0.9):
        assert spectral_radius(ratio, 0.99 * ratio, plant="euler") < 1.0
        assert spectral_radius(ratio, 1.02 * ratio, plant="euler") > 1.0


def test_a_held_command_leaves_no_room_for_rho_one() -> None:
    """With a held command the position form is unstable at rho = 1 for every lambda, and everywhere with a delay."""
    ratios = np.geomspace(1e-8, 1e4, 60)
    assert (stability_map(ratios, np.array([1.0])) > 1.0).all()
    assert (stability_map(ratios, np.geomspace(1e-6, 1.0, 30), delay=1) > 1.0 - 1e-9).all()


def test_the_largest_stable_rho_of_the_position_form() -> None:
    """The largest stable rho is 0.12, at phi^2 / lambda = 0.5; from 2 on there is none."""
    ratios, rhos = np.array([0.1, 0.25, 0.5, 1.0, 2.0, 10.0]), np.geomspace(1e-4, 1.0, 800)
    stable = stability_map(ratios, rhos) < 1.0 - 1e-9
    largest = [rhos[row].max() if row.any() else 0.0 for row in stable]
    assert max(largest) == pytest.approx(0.12, abs=0.005)
    assert int(np.argmax(largest)) == 2
    assert largest[4:] == [0.0, 0.0]


@pytest.mark.parametrize("lead", [5.0, 20.0, 100.0, 200.0])
def test_the_rate_augmented_output_is_stable_at_rho_one(lead: float) -> None:
    """At rho = 1 the loop of z is stable if and only if phi^2 / lambda exceeds about T / c; a delay leaves no room."""
    border = 1.0 / lead
    assert (stability_map(np.geomspace(1.2 * border, 1e3, 40), np.array([1.0]), lead=lead) < 1.0).all()
    assert (stability_map(np.geomspace(1e-6, 0.8 * border, 40), np.array([1.0]), lead=lead) > 1.0).all()
    assert (stability_map(np.geomspace(1e-6, 1e3, 60), np.array([1.0]), delay=1, lead=lead) > 1.0 - 1e-9).all()


@pytest.mark.parametrize("lead", [20.0, 100.0])
def test_a_small_rho_survives_a_delay(lead: float) -> None:
    """At rho = 0.03 the loop of z is stable with a delay of one period over two decades of phi^2 / lambda."""
    ratios = np.geomspace(1.5 / lead, 20.0, 40)
    assert (stability_map(ratios, np.array([0.03]), delay=1, lead=lead) < 1.0).all()
