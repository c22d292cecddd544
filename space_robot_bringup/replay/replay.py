"""The command ``replay``: one bag or many, judged one by one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from space_robot_bringup.experiment.experiment import Overrides
from space_robot_bringup.logs.foreign_bag import PLAIN, Source
from space_robot_bringup.modes.compilation import notice
from space_robot_bringup.replay.comparison import EXACT, Tolerance
from space_robot_bringup.replay.controller import replay_controller
from space_robot_bringup.replay.plant import replay_plant
from space_robot_bringup.replay.recording import NO_CODE, Code, Recording, open_recording
from space_robot_bringup.replay.result import Outcome
from space_robot_bringup.replay.supervisor import replay_supervisor
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.paths import StrPath

SIDES = {"controller": replay_controller, "plant": replay_plant, "supervisor": replay_supervisor}
# What is compared where nothing is said: all that the run has.
ALL = "both"


@dataclass(frozen=True, slots=True)
class ReplayOptions:
    """What to replay and how.

    Attributes:
        against: ``controller``, ``plant``, ``supervisor`` or ``both``: all of them that the run has.
        tolerance: what counts as equal.
        overrides: of the recorded experiment, see ``load_experiment``.
        experiment: for bags without one.
        source: where the topics are in a bag of another tool.
        code: of laws that may be run; of the log alone none is.
    """

    against: str = "both"
    tolerance: Tolerance = EXACT
    overrides: Overrides = ()
    experiment: StrPath | None = None
    source: Source = PLAIN
    code: Code = NO_CODE

    def __post_init__(self) -> None:
        if self.against not in (*SIDES, ALL):
            raise SpecError("no such side", key="--against", value=self.against, accepted=", ".join((*SIDES, ALL)))

    def sides(self, recording: Recording) -> tuple[str, ...]:
        """What is computed again of a run."""
        external = recording.composition.experiment.controller.external
        if external and self.against == "controller":
            accepted = "--against plant, or --set controller.law=NAME"
            raise SpecError("the run had none of its own", key="--against", value=self.against, accepted=accepted)
        if self.against != ALL:
            return (self.against,)
        watched = recording.composition.experiment.supervision is not None
        left_out = {"supervisor": not watched, "controller": external}
        return tuple(side for side in SIDES if not left_out.get(side))


@dataclass(frozen=True, slots=True)
class Replayed:
    """A bag and what came out of it.

    Attributes:
        recording: the bag.
        outcomes: one for each side.
    """

    recording: Recording
    outcomes: tuple[Outcome, ...]

    @property
    def equal(self) -> bool:
        """Nothing is different on any side."""
        return all(outcome.equal for outcome in self.outcomes)


def replay(bag: Path, options: ReplayOptions, on_notice: Callable[[str], None] = lambda line: None) -> Replayed:
    """Compute one recorded run again.

    Args:
        bag: of any tool.
        options: what to do with it.
        on_notice: called with what has to be compiled first, which takes a while.

    Raises:
        SpaceRobotError: the bag or an option cannot be used.
    """
    recording = open_recording(
        bag, experiment=options.experiment, overrides=options.overrides, source=options.source, code=options.code
    )
    composition, plant = recording.composition, options.against in ("plant", ALL)
    # Of a plant alone no law is made.
    laws = composition.experiment.controller if options.against != "plant" else None
    if line := notice(laws.law_names if laws else (), plant=plant, policy=composition.policy):
        on_notice(line)
    return Replayed(recording, tuple(SIDES[side](recording, options.tolerance) for side in options.sides(recording)))
