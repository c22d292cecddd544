"""The headless mode: plant, controller and reference in one loop, without ROS."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import cast

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.fused.sink import FusedRun
from space_robot_bringup.modes import headless
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.signals import Interrupted
from space_robot_control.laws.guarded import LawError, guarded_update
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.interfaces import (
    Controller,
    ControlOutput,
    Plant,
    PlantSample,
    Reference,
    ReferenceSource,
    Sink,
    SupervisedController,
    SupervisedPlant,
    Supervision,
    SupervisorUnit,
    Tick,
)
from space_robot_msgs_py.log.writer import LogSink, MemorySink


def run(
    plant: Plant,
    controller: Controller,
    reference: ReferenceSource,
    *,
    steps: int,
    sink: Sink,
    supervisor: SupervisorUnit | None = None,
    on_tick: Callable[[int], None] = lambda tick: None,
    stop: Callable[[], str | None] = lambda: None,
    on_failure: Callable[[BaseException], None] = lambda error: None,
) -> str:
    """Run ``steps`` control periods and record ticks 0..steps.

    Every state is answered, the last one too (its command acts on nothing), so that all modes log the same.

    Args:
        plant: the true robot.
        controller: the law.
        reference: the desired motion.
        steps: number of control periods.
        sink: takes every tick; it is closed with the reason of the end, whatever happens.
        supervisor: looks at every state before the controller, which is then a ``SupervisedController``.
        on_tick: called with each finished tick.
        stop: asked before each tick; a reason ends the run.
        on_failure: called with the error of a law, plant, reference or sink that ended the run.

    Returns:
        The reason of the end: ``completed``, what ``stop`` said, or the error of plant, controller or log, by the names
        of the nodes they have in a graph.
    """
    reason, at = "failed", Position()
    try:
        course = ticks(
            plant,
            controller,
            reference,
            steps=steps,
            supervisor=supervisor,
            at=at,
            unanswered=sink.record_unanswered,
        )
        reason = _recorded(course, steps, sink, on_tick, stop, at)
    except SpaceRobotError as error:
        reason = f"{'recorder' if isinstance(error, LogError) else at.role}: {error}"
        on_failure(error)
    except Interrupted as interruption:
        reason = interruption.reason
        stop()  # It raises again until it is asked.
    except BaseException as error:
        reason = f"{at.role}: {type(error).__name__}: {error}"
        raise
    finally:
        reason = _closed(sink, reason, on_failure)
    return reason


class Position:
    """Whose turn it is, by the names of the nodes in a graph."""

    __slots__ = ("role",)

    def __init__(self) -> None:
        self.role = "simulator"


def ticks(
    plant: Plant,
    controller: Controller,
    reference: ReferenceSource,
    *,
    steps: int,
    supervisor: SupervisorUnit | None = None,
    at: Position | None = None,
    unanswered: Callable[[PlantSample, Reference, Supervision | None], None] = lambda *_: None,
) -> Iterator[Tick]:
    """Ticks 0..steps of a run, each computed when it is asked for.

    Args:
        plant: the true robot.
        controller: the law.
        reference: the desired motion.
        steps: number of control periods.
        supervisor: see ``run``.
        at: is kept up to date.
        unanswered: called with a state to which the controller has no answer, before its error.
    """
    at = at or Position()
    controller.reset()
    if supervisor is not None:
        supervisor.reset()
    found: Supervision | None = None
    output: ControlOutput | None = None
    obeys = plant if supervisor is not None and isinstance(plant, SupervisedPlant) else None
    sample = plant.reset()
    for tick in range(steps + 1):
        at.role = "guidance"
        target = reference.at(sample.state.stamp)
        if supervisor is not None:
            at.role = "supervisor"
            found = supervisor.update(sample.state, target, output, sample.events)
            cast(SupervisedController, controller).supervise(found)
        at.role = "controller"
        try:
            output = guarded_update(controller, sample.state, target, tick)
        except (SpaceRobotError, Interrupted):
            unanswered(sample, target, found)
            raise
        yield Tick(sample, target, output, found)
        at.role = "simulator"
        if tick < steps:
            if obeys is not None and found is not None:
                obeys.close_brakes(found.brakes)
                obeys.unload_wheels(found.unload)
            sample = plant.step(output.command)


def _recorded(
    course: Iterator[Tick],
    steps: int,
    sink: Sink,
    on_tick: Callable[[int], None],
    stop: Callable[[], str | None],
    at: Position,
) -> str:
    for tick in range(steps + 1):
        reason = stop()
        if reason is not None:
            return reason
        found = next(course)
        at.role = "recorder"
        sink.record(found)
        on_tick(tick)
        at.role = "simulator"
    return "completed"


def _closed(sink: Sink, reason: str, on_failure: Callable[[BaseException], None]) -> str:
    """Close the sink; the reason is another one where it cannot be closed."""
    try:
        sink.close(reason)
    except LogError as error:
        on_failure(error)
        return f"recorder: {error}"
    return reason


def run_in_memory(composition: Composition, hooks: Hooks | None = None) -> MemorySink | FusedRun:
    """Run a composition in the headless mode; the sink has its ticks and the reason of its end.

    Writing and reading a log takes three times as long as the run. Without hooks a run whose parts are compiled is one
    compiled call, which changes no bit and takes a third of the time.

    Raises:
        SpaceRobotError: plant, law or reference cannot be made; nothing was run.
        Exception: what the law raised, where no law should.
    """
    if hooks is None:
        # Only here: it loads a compiler.
        from space_robot_bringup.fused.run import compiled_run

        if (fused := compiled_run(composition)) is not None:
            return fused
    hooks, sink = hooks or Hooks(), MemorySink()
    failures: list[BaseException] = []
    controller = composition.controller()
    headless.run(
        composition.plant(),
        controller,
        composition.reference(),
        steps=composition.experiment.steps,
        sink=sink,
        supervisor=composition.supervisor(controller),
        on_tick=hooks.on_tick,
        stop=hooks.stop,
        on_failure=failures.append,
    )
    for failure in failures:
        if isinstance(failure, LawError) and isinstance(failure.__cause__, Exception):
            raise failure.__cause__
        hooks.on_failure(failure)
    return sink


def write_bag(sink: MemorySink | FusedRun, composition: Composition, directory: Path) -> None:
    """Write the bag that the run would have left in the headless mode, bit for bit.

    Raises:
        LogError: the directory holds something else, or cannot be written.
    """
    log = LogSink(directory, composition.header, custom={"mode": "headless"})
    for tick in sink.ticks:
        log.record(tick)
    if sink.unanswered is not None:
        log.record_unanswered(*sink.unanswered)
    log.close(sink.end_reason or "interrupted")
