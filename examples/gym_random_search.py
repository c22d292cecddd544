"""Search the gains of a linear feedback by trial and error in a gymnasium environment (extra ``gym``).

    python examples/gym_random_search.py

Each trial is an episode of the shipped task: 40 s with the robot, actuators and sensors of the experiment.
"""

import gymnasium
import numpy as np

import space_robot.gym  # noqa: F401  registers the ids

TRIALS = 4


def episode(env: gymnasium.Env, gains: np.ndarray, seed: int = 0) -> float:
    """The sum of rewards under u = kp * error + kd * rate error."""
    observation, _ = env.reset(seed=seed)
    axes = env.action_space.shape[0]
    total, over = 0.0, False
    while not over:
        # The last entries of an observation: error, then rate error, of the axes that an action has.
        size = env.unwrapped.plant.state.v.size
        error, rate = observation[-2 * size : -size][-axes:], observation[-axes:]
        observation, reward, failed, late, _ = env.step(gains[0] * error + gains[1] * rate)
        total, over = total + float(reward), failed or late
    return total


def main() -> None:
    """Print the best gains that a few random trials find."""
    env, rng = gymnasium.make("space_robot/liu2023-fig08-v0"), np.random.default_rng(1)
    best = (episode(env, np.zeros(2)), np.zeros(2))
    for _ in range(TRIALS):
        gains = np.exp(rng.uniform(-4.0, 0.0, size=2))
        best = max(best, (episode(env, gains), gains), key=lambda one: one[0])
    print(f"reward {best[0]:.3f} with kp = {best[1][0]:.3f}, kd = {best[1][1]:.3f}")


if __name__ == "__main__":
    main()
