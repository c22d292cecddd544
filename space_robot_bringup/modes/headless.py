"""The headless mode: plant, controller and reference in one loop, without ROS."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.modes import headless
from space_robot_bringup.modes.hooks import Hooks
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import Controller, Plant, ReferenceSource, Sink, Tick
from space_robot_msgs_py.log.writer import LogSink, MemorySink


def run(
    plant: Plant,
    controller: Controller,
    reference: ReferenceSource,
    *,
    steps: int,
    sink: Sink,
    on_tick: Callable[[int], None] = lambda tick: None,
    stop: Callable[[], str | None] = lambda: None,
) -> str:
    """Fly ``steps`` control periods and record ticks 0..steps.

    Every state is answered, the last one too (its command acts on nothing), so that all modes log the same.

    Args:
        plant: the true robot.
        controller: the law.
        reference: the desired motion.
        steps: number of control periods.
        sink: takes every tick; it is closed with the reason of the end, whatever happens.
        on_tick: called with each finished tick.
        stop: asked before each tick; a reason ends the run.

    Returns:
        The reason of the end: ``completed``, what ``stop`` said, or the error of plant or controller.
    """
    reason = "interrupted"
    try:
        reason = _loop(plant, controller, reference, steps, sink, on_tick, stop)
    except SpaceRobotError as error:
        reason = str(error)
    finally:
        sink.close(reason)
    return reason


def _loop(
    plant: Plant,
    controller: Controller,
    reference: ReferenceSource,
    steps: int,
    sink: Sink,
    on_tick: Callable[[int], None],
    stop: Callable[[], str | None],
) -> str:
    controller.reset()
    sample = plant.reset()
    for tick in range(steps + 1):
        reason = stop()
        if reason is not None:
            return reason
        target = reference.at(sample.state.stamp)
        try:
            output = controller.update(sample.state, target)
        except SpaceRobotError as error:
            sink.record_unanswered(sample, target)
            return f"controller: {error}"
        sink.record(Tick(sample, target, output))
        on_tick(tick)
        if tick < steps:
            try:
                sample = plant.step(output.command)
            except SpaceRobotError as error:
                return f"simulator: {error}"
    return "completed"


def fly_in_memory(composition: Composition, hooks: Hooks | None = None) -> MemorySink:
    """Fly a composition in the headless mode; the sink has its ticks and the reason of its end.

    Writing and reading a log takes three times as long as the flight.

    Raises:
        SpaceRobotError: plant, law or reference cannot be made; nothing was flown.
    """
    hooks, sink = hooks or Hooks(), MemorySink()
    headless.run(
        composition.plant(),
        composition.controller(),
        composition.reference(),
        steps=composition.experiment.steps,
        sink=sink,
        on_tick=hooks.on_tick,
        stop=hooks.stop,
    )
    return sink


def write_bag(sink: MemorySink, composition: Composition, directory: Path) -> None:
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
