"""An experiment as an environment of gymnasium: the plant of the run, commanded by an agent in place of a law."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import Experiment, Overrides, with_changes
from space_robot_bringup.public.calls import for_python
from space_robot_bringup.public.given import given_experiment
from space_robot_bringup.public.stepping import SteppedPlant
from space_robot_control.tracking import tracking_errors
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.errors import CommandError, NonFiniteError, SpaceRobotError, SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.paths import StrPath

# Of a plant, after each control period.
Reward = Callable[[SteppedPlant], float]
MAX_SEED = 2**53


def tracking_reward(plant: SteppedPlant) -> float:
    """Minus the squared errors of the measured state over a control period.

    -(|e_p|^2 [m^2] + |e_R|^2 [rad^2] + |e_q|^2 [rad^2 or m^2]) T, without the position of a free-floating base.
    """
    errors = tracking_errors(plant.state, plant.reference).configuration
    counted = errors if plant.robot.base_mode == "free_flying" else errors[3:]
    return -float(counted @ counted) * plant.control_period


class SpaceRobotEnv(gymnasium.Env[Vector, Vector]):
    """An experiment without its law: an action is the command of one control period, or of several.

    The plant is that of a run, with its actuators, sensors, delays and faults: the same commands give the same states,
    bit for bit. An episode lasts as long as the experiment.

    Actions (6+n,) of a free-flying robot: force [N] and torque [N m] on the base, body frame, joint efforts [N m or N];
    (3+n,) of a free-floating one, without force. The space is what the actuators can do about each axis by itself; what
    an action has beyond it they cut off. Observations (7+n + 3 (6+n),): measured q and v, as in ``RobotState``, then
    error and rate error to the reference, as in ``tracking_errors``.

    Args:
        experiment: see ``run``.
        overrides: see ``run``.
        steps: control periods that an action is held for.
        reward: of each control period, summed over an action; None: ``tracking_reward``.

    Attributes:
        plant: the plant of this episode, with its ``reference``, ``robot`` and ``sample``.

    Raises:
        SpaceRobotError: the experiment cannot be used.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012

    @for_python
    def __init__(
        self,
        experiment: StrPath | Experiment,
        overrides: Overrides | None = None,
        *,
        steps: int = 1,
        reward: Reward | None = None,
    ) -> None:
        if steps < 1:
            raise SpecError("not a number of control periods", key="steps", value=steps, accepted="1 or more")
        self._experiment, self._steps = given_experiment(experiment, overrides), steps
        self._reward = reward or tracking_reward
        self.plant = SteppedPlant(compose(self._experiment))
        self._seed, self._begun = self._experiment.seed, False
        super().reset(seed=self._seed)
        self._force = 0 if self.plant.robot.base_mode == "free_flying" else 3
        limits = action_limits(self.plant.robot)[self._force :]
        self.action_space = gymnasium.spaces.Box(-limits, limits, dtype=np.float64)
        shape = self._observed().shape
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, shape, np.float64)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Vector, dict[str, Any]]:
        """Begin an episode.

        Args:
            seed: of the experiment: noise and dispersion are those of its run with this seed. None: the experiment's
                own for the first episode, then drawn.
            options: none are known.
        """
        del options
        super().reset(seed=seed)
        if seed is None and self._begun:
            seed = int(self.np_random.integers(MAX_SEED))
        if seed is not None and seed != self._seed:
            self._seed = seed
            self.plant = SteppedPlant(compose(with_changes(self._experiment, {"seed": seed})))
        elif self._begun:
            self.plant.reset()
        self._begun = True
        return self._observed(), self._said()

    def step(self, action: Vector) -> tuple[Vector, float, bool, bool, dict[str, Any]]:
        """Hold a command for ``steps`` control periods, or until the experiment ends.

        Returns:
            Observation, reward, whether the plant cannot go on (``info["error"]`` says why), whether the experiment's
            duration is over, and the info: ``stamp`` [ns], ``attitude_error`` [rad], ``joint_error`` [rad or m].

        Raises:
            CommandError: the action has another size.
            NonFiniteError: it has a number that is not finite.
        """
        u = np.concatenate((np.zeros(self._force), np.asarray(action, dtype=np.float64).ravel()))
        earned, end = 0.0, self._experiment.steps * self._experiment.period
        for _ in range(self._steps):
            try:
                self.plant.step(u)
            except (CommandError, NonFiniteError):
                raise
            except SpaceRobotError as error:
                return self._observed(), earned, True, False, self._said() | {"error": str(error)}
            earned += self._reward(self.plant)
            if self.plant.state.stamp >= end:
                break
        return self._observed(), earned, False, self.plant.state.stamp >= end, self._said()

    def _observed(self) -> Vector:
        state = self.plant.state
        errors = tracking_errors(state, self.plant.reference)
        return np.concatenate((state.q, state.v, errors.configuration, errors.velocity))

    def _said(self) -> dict[str, Any]:
        errors = tracking_errors(self.plant.state, self.plant.reference)
        return {
            "stamp": self.plant.state.stamp,
            "attitude_error": float(np.linalg.norm(errors.attitude)),
            "joint_error": float(np.abs(errors.joints).max(initial=0.0)),
        }


def action_limits(robot: Robot) -> Vector:
    """(6+n,) largest force [N], torque [N m] and efforts [N m or N] that the actuators can give on each axis by itself.

    Raises:
        SpecError: a joint has no finite limit.
    """
    limits = np.zeros(6 + robot.n)
    torque, force = robot.actuators.base_torque, robot.actuators.base_force
    if force is not None:
        limits[:3] = force.limit
    if isinstance(torque, ReactionWheels):
        axes = np.array(torque.axes)
        limits[3:6] = np.abs(axes / np.linalg.norm(axes, axis=1, keepdims=True)).sum(axis=0) * torque.torque
    else:
        limits[3:6] = torque.limit
    limits[6:] = robot.effort_limit
    if not np.isfinite(limits).all():
        raise SpecError("an environment needs finite limits", key="actuators.joints.effort", value=limits[6:].tolist())
    return limits
