"""Whole runs: tick by tick, in one compiled call, and side by side in lanes; MuJoCo's open-loop rollout beside them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import process_time

import numpy as np

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment, with_duration
from space_robot_bringup.fused.lanes import compiled_runs
from space_robot_bringup.fused.run import compiled_run
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_bringup.modes.hooks import Hooks
from space_robot_description.kernel.lanes import LANES
from space_robot_description.load import load_robot
from tests.support.robots import MujocoTwin

PERIODS, REPEATS, RUNS = 1500, 5, 8
CASES: dict[str, tuple[str, tuple[str, ...]]] = {
    "ntsmc, servicer": ("giordano2023/sec5", ()),
    "ntsmc_euler, servicer": ("giordano2023/sec5_euler", ()),
    "adaptive, mini, noisy": ("liu2023/fig08", ("plant.sensors.attitude.noise=1e-4", "plant.delay_periods=1")),
    "adaptive with rls, mini": ("liu2023/fig08", ("controller.gains.update=rls",)),
    "computed_torque, servicer": ("compare/servicer", ()),
    "mfac, servicer": ("song2023/servicer", ()),
    "pd, mini": ("song2023/mini", ("controller={law: pd, gains: {bandwidth: 0.2}}",)),
}


def run() -> dict[str, float]:
    """CPU microseconds per period of whole runs, making of parts and references included; the least of five turns."""
    table: dict[str, float] = {}
    for name, (case, changes) in CASES.items():
        table |= {f"{name}: {what}": value for what, value in measured(case, changes, PERIODS, REPEATS).items()}
    fused, lanes = (table[f"ntsmc, servicer: {way}, CPU us per period"] for way in ("one call", f"{LANES} lanes"))
    rollout = 1e6 * rollout_seconds(REPEATS)
    table["MuJoCo's rollout, RK4 5 ms, servicer, open loop: CPU us per period of 0.1 s"] = rollout
    table["MuJoCo's rollout over a closed-loop run of ntsmc, servicer, one call"] = rollout / fused
    table[f"MuJoCo's rollout over a closed-loop run of ntsmc, servicer, {LANES} lanes"] = rollout / lanes
    return table


def measured(case: str, changes: Sequence[str], periods: int, repeats: int) -> dict[str, float]:
    """CPU microseconds per period and run of a case done in three ways, and the ratios; the least of some turns.

    Args:
        case: an experiment.
        changes: of it.
        periods: of a run.
        repeats: turns.
    """
    experiment = load_experiment(case, changes)
    experiment = with_duration(experiment, periods * experiment.period / 1e9)
    compositions = [compose(experiment.model_copy(update={"seed": seed})) for seed in range(RUNS)]
    ways: dict[str, tuple[Callable[[], None], int]] = {
        "loop": (lambda: _loop(compositions[0]), 1),
        "one call": (lambda: _one_call(compositions[0]), 1),
        f"{LANES} lanes": (lambda: _lanes(compositions), RUNS),
    }
    least = dict.fromkeys(ways, float("inf"))
    for _ in range(1 + repeats):
        # The first turn loads kernels.
        for way, (once, runs) in ways.items():
            begin = process_time()
            once()
            least[way] = min(least[way], (process_time() - begin) / runs)
    table = {f"{way}, CPU us per period": 1e6 * seconds / periods for way, seconds in least.items()}
    return table | {f"loop over {way}": least["loop"] / seconds for way, seconds in least.items() if way != "loop"}


def _loop(composition: Composition) -> None:
    assert run_in_memory(composition, Hooks()).end_reason == "completed"


def _one_call(composition: Composition) -> None:
    assert compiled_run(composition) is not None


def _lanes(compositions: Sequence[Composition]) -> None:
    assert None not in compiled_runs(compositions)


def rollout_seconds(repeats: int, periods: int = 50) -> float:
    """CPU seconds of MuJoCo per period of 0.1 s of ``servicer`` that nothing acts on; the least of some turns."""
    import mujoco
    from mujoco import rollout

    twin = MujocoTwin(load_robot("servicer").model, 0.005)
    state = np.empty(mujoco.mj_stateSize(twin.model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(twin.model, twin.data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    initial, steps, least = np.tile(state, (RUNS, 1)), 20 * periods, float("inf")
    for _ in range(repeats):
        begin = process_time()
        rollout.rollout(twin.model, [twin.data], initial, nstep=steps)
        least = min(least, (process_time() - begin) / (RUNS * periods))
    return least
