"""The environment of gymnasium is the plant of a run."""

from __future__ import annotations

import sys
import warnings
from importlib import import_module
from typing import Any

import numpy as np
import pytest

import space_robot as sr
from space_robot_msgs_py.interfaces import Vector

gymnasium = pytest.importorskip("gymnasium")
from gymnasium.utils.env_checker import check_env  # noqa: E402

from space_robot.gym import SpaceRobotEnv, action_limits, ids  # noqa: E402

NAME, ID = "liu2023/fig08", "space_robot/liu2023-fig08-v0"
NOISY = {
    "plant.sensors.attitude.noise": 1e-3,
    "plant.dispersion.eta": 0.1,
    "plant.delay_periods": 1,
    "nominal.delay_periods": 1,
    "expect": {},
}
# What it remarks and is meant: rates have no bounds, and actions are in N, N m, which RescaleAction brings to -1..1.
MEANT = ("infinity", "normalized")


class RandomCommands(sr.Law):
    """Commands that do not care for the state."""

    name = "random_commands"
    uses_command_delay = True

    def reset(self) -> None:
        super().reset()
        self._rng = np.random.default_rng(3)

    def compute(self, state: sr.RobotState, reference: sr.Reference) -> tuple[Vector, sr.Blocks]:
        u = self._rng.uniform(-0.01, 0.01, 6 + self.n) * action_limits(self.robot)
        return u, {}


LAW = f"{__name__}:RandomCommands"


def agree(ticks: int) -> None:
    """An environment that is given the commands of a headless run goes through its states."""
    changes = NOISY | {"controller.law": LAW, "duration": 0.25 * ticks, "seed": 11}
    run = sr.run(NAME, changes)
    assert run.reason == "completed"
    env = SpaceRobotEnv(NAME, NOISY | {"duration": 0.25 * ticks})
    observation, _ = env.reset(seed=11)
    commands = np.hstack([run.arrays.command.torque, run.arrays.command.effort])
    base, joints = run.arrays.base, run.arrays.joints
    q = np.hstack([base.position, base.quaternion, joints.position])
    v = np.hstack([base.linear_velocity, base.angular_velocity, joints.velocity])
    size = q.shape[1] + v.shape[1]
    for k in range(ticks):
        assert observation[:size].tobytes() == np.concatenate((q[k], v[k])).tobytes(), k
        observation, _, failed, late, _ = env.step(commands[k])
        assert (failed, late) == (False, k == ticks - 1)
    assert observation[:size].tobytes() == np.concatenate((q[-1], v[-1])).tobytes()


def test_the_states_are_those_of_a_headless_run() -> None:
    """Bit for bit under the same commands, with noise, dispersion and delay, over 200 periods."""
    agree(200)


@pytest.mark.thorough
def test_ten_thousand_states_are_those_of_a_headless_run() -> None:
    """The same over 10,000 periods."""
    agree(10_000)


@pytest.mark.parametrize("name", [NAME, "giordano2023/sec5"])
def test_the_checker_of_gymnasium_finds_nothing(name: str) -> None:
    """Of a free-floating and of a free-flying robot; what it remarks are the two things that are meant."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        check_env(SpaceRobotEnv(name, {"duration": 5.0, "expect": {}}), skip_render_check=True)
    assert [str(one.message) for one in said if not any(word in str(one.message) for word in MEANT)] == []


def test_every_shipped_experiment_has_an_id() -> None:
    """One id for each, none for two; importing twice changes nothing."""
    from space_robot_description.share import shipped

    names = shipped("experiments")
    assert len(set(ids)) == len(names) == len(ids)
    assert ID in ids
    assert set(ids) <= set(gymnasium.registry)
    assert gymnasium.spec(ID).kwargs == {"experiment": NAME}
    module: Any = import_module("space_robot_bringup.public.gym_ids")
    assert module.register() == ids


def test_an_action_is_held_for_several_periods() -> None:
    """The state after one action of N periods is that after N of one, and the rewards add up."""
    once, often = (SpaceRobotEnv(NAME, NOISY | {"duration": 3.0}, steps=steps) for steps in (5, 1))
    action = once.action_space.high * 0.01
    once.reset()
    often.reset()
    seen, reward, *_ = once.step(action)
    rewards = []
    for _ in range(5):
        other, one, *_ = often.step(action)
        rewards.append(one)
    assert seen.tobytes() == other.tobytes()
    assert reward == sum(rewards)
    # The last action ends with the experiment: 12 periods are 5 + 5 + 2.
    assert [once.step(action)[3] for _ in range(2)] == [False, True]


def test_episodes_are_seeded() -> None:
    """The same seed is the same noise; without one the first episode is the experiment's, the next ones differ."""
    seen = []
    for _ in range(2):
        env = SpaceRobotEnv(NAME, NOISY)
        seen.append([env.reset(seed=seed)[0].tobytes() for seed in (None, 5, None, None, 5)])
    first, second = seen
    assert first == second
    assert first[1] == first[4]
    assert len({*first}) == 4
    assert first[0] == SpaceRobotEnv(NAME, NOISY).reset(seed=sr.load_experiment(NAME).seed)[0].tobytes()


def test_environments_run_beside_each_other() -> None:
    """A vector of two gives what each gives by itself."""
    vector = gymnasium.make_vec(ID, num_envs=2, vectorization_mode="sync", overrides=NOISY)
    seen, _ = vector.reset(seed=4)
    actions = vector.action_space.high * 0.01
    after, *_ = vector.step(actions)
    vector.close()
    for index in range(2):
        env = SpaceRobotEnv(NAME, NOISY)
        assert env.reset(seed=4 + index)[0].tobytes() == seen[index].tobytes()
        assert env.step(actions[index])[0].tobytes() == after[index].tobytes()


def test_without_gymnasium_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """As an ImportError, which is what importing something that is missing raises."""
    for name in ("space_robot.gym", "space_robot_bringup.public.environment"):
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(ImportError, match=r"needs gymnasium .*space-robot\[gym\]"):
        import_module("space_robot.gym")


def test_what_cannot_be_is_one_error() -> None:
    """A wrong size, a number that is not finite, no period; the words are those of the arguments."""
    env = gymnasium.make(ID, disable_env_checker=True)
    env.reset()
    for action in (np.zeros(3), np.full(env.action_space.shape, np.nan)):
        with pytest.raises(sr.SpaceRobotError, match=r"command|finite"):
            env.step(action)
    with pytest.raises(sr.SpaceRobotError, match=r"^steps: not a number of control periods; got 0"):
        SpaceRobotEnv(NAME, steps=0)
    with pytest.raises(sr.SpaceRobotError, match=r"no_such_key: unknown key"):
        gymnasium.make(ID, overrides={"no_such_key": 1})
