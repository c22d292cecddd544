"""A log as arrays block by block: what one block takes of memory is all that is needed at once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from space_robot_msgs_py.codec.tick_codec import TickCodec
from space_robot_msgs_py.codec.tick_events import diagnostics_of, events_of
from space_robot_msgs_py.errors import LayoutError, LogError, SpaceRobotError
from space_robot_msgs_py.events import ControllerEvent, DiagnosticEvent
from space_robot_msgs_py.interfaces import Tick
from space_robot_msgs_py.log.arrays import LogArrays, Row, arrays_of, stack_ticks
from space_robot_msgs_py.topics import CONTROLLER_TELEMETRY, PLANT_TELEMETRY

# Ticks that are stacked at once.
BLOCK = 512


@dataclass(frozen=True, eq=False, slots=True)
class Block:
    """Successive complete ticks of a log.

    Attributes:
        arrays: those that fit the robot, stacked; None where none does.
        events: what was changed at them, in order.
        diagnostics: what happened at them, in order.
        unfit: stamp [ns] of each other one, and why it does not fit.
    """

    arrays: LogArrays | None
    events: tuple[ControllerEvent, ...] = ()
    diagnostics: tuple[DiagnosticEvent, ...] = ()
    unfit: tuple[tuple[int, SpaceRobotError], ...] = ()


class BlockStacker:
    """Stacks the ticks of a log in blocks; the ticks that fit are those a TickCodec decodes.

    Args:
        joint_names: the robot's joints in model order.
        key: the file, for error messages.
    """

    def __init__(self, joint_names: Sequence[str], key: str) -> None:
        self._codec, self._joint_names, self._key = TickCodec(joint_names), tuple(joint_names), key
        self._shapes: dict[str, dict[str, int]] | None = None

    def blocks(self, rows: Iterable[Row], size: int = BLOCK) -> Iterator[Block]:
        """All rows, ``size`` at a time.

        Raises:
            LogError: the shape of telemetry changes in the course of the log.
        """
        left = iter(rows)
        while taken := list(islice(left, size)):
            block = self._stack(taken)
            # The messages go before the next ones come.
            del taken
            yield block

    def _stack(self, rows: Sequence[Row]) -> Block:
        try:
            arrays = stack_ticks(rows, self._joint_names, self._key, one_stamp=True)
            events = tuple(event for stamp, parts in rows for event in events_of(parts, stamp))
            block = Block(arrays, events, tuple(one for stamp, parts in rows for one in diagnostics_of(parts, stamp)))
        except SpaceRobotError:
            # Cutting all at once is ten times faster than decoding, but all or nothing.
            block = self._one_by_one(rows)
        if block.arrays is not None:
            self._check_shapes(block.arrays)
        return block

    def _one_by_one(self, rows: Sequence[Row]) -> Block:
        ticks, unfit = list[Tick](), list[tuple[int, SpaceRobotError]]()
        for stamp, parts in rows:
            try:
                ticks.append(self._codec.decode(parts))
            except SpaceRobotError as error:
                unfit.append((stamp, error))
        try:
            arrays = arrays_of(ticks) if ticks else None
        except LayoutError as error:
            raise LogError(f"the messages of a topic differ: {error}", key=self._key) from None
        events = tuple(event for tick in ticks for event in tick.output.events)
        return Block(arrays, events, tuple(one for tick in ticks for one in tick.diagnostics), tuple(unfit))

    def _check_shapes(self, arrays: LogArrays) -> None:
        """Blocks of telemetry have to be the same ones in the whole log."""
        sides = {CONTROLLER_TELEMETRY.name: arrays.controller, PLANT_TELEMETRY.name: arrays.plant}
        shapes = {topic: {name: block.shape[1] for name, block in side.items()} for topic, side in sides.items()}
        if self._shapes is None:
            self._shapes = shapes
        for topic, shape in shapes.items():
            if list(shape.items()) != list(self._shapes[topic].items()):
                when = f"up to {arrays.time[-1]:g} s"
                raise LogError(f"the messages of a topic differ: {topic} changes its blocks", key=self._key, value=when)
