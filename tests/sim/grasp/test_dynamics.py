"""The compiled step of a robot with a grasp, compared with the same equations over Pinocchio."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_description.kernel import jit
from space_robot_sim.grasp.dynamics import GraspDynamics, Push
from space_robot_sim.grasp.plant import GraspedBody


def dynamics(name: str) -> GraspDynamics:
    """Those of an experiment's plant."""
    plant = compose(load_experiment(name)).plant()
    assert isinstance(plant, GraspedBody)
    return plant.dynamics


@pytest.mark.parametrize("name", ["song2023/attitude_6_85", "song2023/pccs"])
def test_a_compiled_step_is_that_of_pinocchio(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Random states and pushes, wheels with lag, springs and slip: equal to 1e-13 of the largest number."""
    compiled = dynamics(name)
    monkeypatch.setattr(jit, "MACHINE_CODE", False)
    oracle, rng = dynamics(name), np.random.default_rng(1)

    def some(count: int) -> tuple[float, ...]:
        return tuple(rng.normal(size=count).tolist())

    for _ in range(20):
        y = 0.3 * rng.normal(size=compiled.size)
        y[3:7] /= np.linalg.norm(y[3:7])
        y[compiled.bristle] *= 0.01
        push = Push(some(3), some(3), some(3), some(compiled.n), some(3), some(3), 0.1, 0.2)  # type: ignore[arg-type]
        found, wanted = (one.step(y, push, 0.0, 0.01) for one in (compiled, oracle))
        np.testing.assert_allclose(found, wanted, rtol=0.0, atol=1e-13 * np.abs(wanted).max())
