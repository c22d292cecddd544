"""`space_robot.make_plant` and `space_robot.closed_loop`: an experiment one control period at a time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import Experiment, Overrides
from space_robot_bringup.modes.headless import ticks
from space_robot_bringup.public.calls import for_python
from space_robot_bringup.public.given import given_experiment
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import CommandError
from space_robot_msgs_py.interfaces import Command, PlantSample, Reference, RobotState, Tick
from space_robot_msgs_py.paths import StrPath


class SteppedPlant:
    """The true robot of an experiment with its actuators, sensors and faults, stepped by the caller.

    The same commands give the same states as in a run, bit for bit: it is the plant of the run.

    Attributes:
        experiment: what it was made from.
        robot: the NOMINAL robot, as a law knows it.
        sample: what the plant shows now: the measured state, telemetry with the truth, faults and events.
    """

    def __init__(self, composition: Composition) -> None:
        self.experiment: Experiment = composition.experiment
        self.robot: Robot = composition.nominal
        self._plant, self._reference = composition.plant(), composition.reference()
        self.sample: PlantSample = self._plant.reset()

    @property
    def state(self) -> RobotState:
        """The measured state."""
        return self.sample.state

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The n joints in model order."""
        return self.robot.joint_names

    @property
    def control_period(self) -> float:
        """[s]."""
        return self.experiment.control_period

    @property
    def reference(self) -> Reference:
        """What the experiment asks of the robot now."""
        return self._reference.at(self.state.stamp)

    def reset(self) -> PlantSample:
        """Back to the initial state; the noise is that of the first time again."""
        self.sample = self._plant.reset()
        return self.sample

    def step(self, command: Command | npt.ArrayLike | None) -> PlantSample:
        """Advance one control period.

        Args:
            command: to the state that is shown; or its numbers, (6 + n,) force [N] and torque [N m] on the base in the
                body frame, then joint efforts [N m or N]; None: there is none, and the plant's ``hold`` acts.

        Returns:
            What the plant shows at the end of the period.

        Raises:
            CommandError: the command is for another state, or does not fit the robot.
            NonFiniteError: it has a number that is not finite.
        """
        self.sample = self._plant.step(None if command is None else self._checked(command))
        return self.sample

    def _checked(self, command: Command | npt.ArrayLike) -> Command:
        if not isinstance(command, Command):
            numbers, size = np.asarray(command, dtype=np.float64), 6 + self.robot.n
            if numbers.shape != (size,):
                raise CommandError("wrong size", key="command", value=numbers.shape, accepted=f"({size},)")
            return Command(self.state.stamp, numbers[:6], numbers[6:])
        if command.effort.size != self.robot.n:
            raise CommandError(
                "wrong size", key="command.effort", value=command.effort.size, accepted=str(self.robot.n)
            )
        if command.stamp != self.state.stamp:
            accepted = f"{self.state.stamp} [ns], that of the state"
            raise CommandError("for another state", key="command.stamp", value=command.stamp, accepted=accepted)
        return command


@for_python
def make_plant(experiment: StrPath | Experiment, overrides: Overrides | None = None) -> SteppedPlant:
    """The plant of an experiment, to be stepped by hand: ``plant.step(u)``.

    Args:
        experiment: see ``run``.
        overrides: see ``run``.

    Raises:
        SpaceRobotError: the experiment cannot be used.
    """
    return SteppedPlant(compose(given_experiment(experiment, overrides)))


@for_python
def closed_loop(experiment: StrPath | Experiment, overrides: Overrides | None = None) -> Iterator[Tick]:
    """Run an experiment one tick at a time, each when it is asked for.

    A tick has the plant's sample, the reference and what the law answered; they are the ticks of ``run``, bit for bit.
    Nothing is logged. A loop may be left at any time.

    Args:
        experiment: see ``run``.
        overrides: see ``run``.

    Raises:
        SpaceRobotError: the experiment cannot be used, at the call; or the law cannot go on, at its tick.
    """
    return _ticks(compose(given_experiment(experiment, overrides)))


def _ticks(composition: Composition) -> Iterator[Tick]:
    controller = composition.controller()
    steps, supervisor = composition.experiment.steps, composition.supervisor(controller)
    yield from ticks(composition.plant(), controller, composition.reference(), steps=steps, supervisor=supervisor)
