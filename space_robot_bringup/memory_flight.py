"""A headless run kept in memory: most runs of a study are looked at once and written nowhere."""

from __future__ import annotations

from pathlib import Path

from space_robot_bringup import closed_loop
from space_robot_bringup.compose import Composition
from space_robot_bringup.run import Hooks
from space_robot_msgs_py.log.writer import LogSink, MemorySink


def fly_in_memory(composition: Composition, hooks: Hooks | None = None) -> MemorySink:
    """Fly a composition in the headless mode; the sink has its ticks and the reason of its end.

    Writing and reading a log takes three times as long as the flight.

    Raises:
        SpaceRobotError: plant, law or reference cannot be made; nothing was flown.
    """
    hooks, sink = hooks or Hooks(), MemorySink()
    closed_loop.run(
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
