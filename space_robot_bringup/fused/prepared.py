"""A run made ready to be one compiled call: parts, references, random numbers and the room for what it leaves."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.experiment.plant import PlantSpec
from space_robot_bringup.fused.kernel.loop import Body, Known, run_ticks
from space_robot_bringup.fused.kernel.records import Desired, Records
from space_robot_bringup.fused.sink import FusedRun
from space_robot_control.kernel.answers import answer_example
from space_robot_control.laws.base import Law
from space_robot_control.laws.compiled import CompiledLaw
from space_robot_control.references.rows import rows_of
from space_robot_description.kernel import jit
from space_robot_description.kernel.context import Context
from space_robot_description.kernel.jit import bound
from space_robot_msgs_py.errors import ControlError
from space_robot_sim.kernel.period import advance
from space_robot_sim.plant import PlantNumbers, SimulatedRobot

# What a law answers is decided in these.
COMPUTES = ("compute", "update", "control", "answer", "on_applied", "note_applied", "reset")


class Parts(NamedTuple):
    """What a compiled run is made of."""

    plant: SimulatedRobot
    body: PlantNumbers
    law: Law
    compiled: CompiledLaw


def prepared(composition: Composition, ticks: int | None = None) -> PreparedRun | None:
    """Make a run ready.

    Args:
        composition: of the run.
        ticks: stop after so many; None: the whole run.

    Returns:
        The run; None where a part of it is not compiled.

    Raises:
        SpaceRobotError: plant, law or reference cannot be made.
    """
    experiment = composition.experiment
    if not jit.MACHINE_CODE or experiment.supervision is not None or composition.faults is not None:
        return None
    if not isinstance(experiment.plant, PlantSpec):
        return None
    parts = _parts(composition)
    return None if parts is None else PreparedRun(composition, parts, ticks)


def _parts(composition: Composition) -> Parts | None:
    """Plant and law, where both can be compiled."""
    law = composition.controller()
    if law.inbox is not None or law.friction.known or not _is_its_own(type(law)):
        return None
    law.reset()
    compiled = law.compiled()
    plant = composition.plant() if compiled is not None else None
    if compiled is None or not isinstance(plant, SimulatedRobot):
        return None
    try:
        compiled.start(plant.reset().state)
    except ControlError:
        # What keeps a law from its first answer ends the run at its first tick, in the words of the loop.
        return None
    body = plant.numbers()
    return None if body is None else Parts(plant, body, law, compiled)


def _is_its_own(law: type[Law]) -> bool:
    """Whether the compiled form is of the class that computes, and not of one that it is derived from."""
    order = [vars(kind) for kind in law.__mro__]
    compiled = next(place for place, names in enumerate(order) if "compiled" in names)
    return not any(name in names for name in COMPUTES for names in order[:compiled])


class PreparedRun:
    """One run; its memory.

    Args:
        composition: of the run.
        parts: of it.
        ticks: see ``prepared``.

    Attributes:
        parts: see above.
        period: control period [ns].
        ticks: how many.
        desired: the reference, tick by tick.
        records: room for what the run leaves.
        known: to the flight software.
        changes: ticks after which another true robot runs.
    """

    def __init__(self, composition: Composition, parts: Parts, ticks: int | None) -> None:
        experiment, n = composition.experiment, parts.law.n
        self.parts, self.period = parts, experiment.period
        self.ticks = min(ticks or experiment.steps + 1, experiment.steps + 1)
        stamps = range(0, self.ticks * self.period, self.period)
        self.desired = Desired(*rows_of(composition.reference(), stamps))
        ideal, sensors = parts.body.sensors.ideal, parts.body.sensors
        # They have shown the first state already.
        sensors.reset()
        self._draws = np.zeros((1, 0)) if ideal else sensors.draws(self.ticks)
        telemetry, count = parts.body.telemetry, self.ticks
        self.records = Records(
            np.empty((count, 16 + 2 * n)),
            np.empty((1 if ideal else count, 16 + 2 * n)),
            np.empty((count, n)),
            np.empty((count, sum(telemetry.sizes))),
            np.empty((count, parts.compiled.layout.size)),
            np.empty((count, 6 + n)),
        )
        self.known = Known(parts.law.wheels.numbers, composition.nominal.command_delay, np.zeros(6 + n))
        changes = (change.stamp // self.period for change in composition.changes)
        self.changes = tuple(sorted({tick for tick in changes if 0 < tick < count - 1}))

    @property
    def sections(self) -> Iterator[tuple[int, int]]:
        """First tick of each part of the run in which one true robot runs, and the tick after its last one."""
        begins = (0, *(change + 1 for change in self.changes))
        return zip(begins, (*begins[1:], self.ticks), strict=True)

    def switch_models(self, begin: int) -> None:
        """Let the true robot run on whose section begins at a tick."""
        if begin:
            self.parts.plant.switch_models(begin - 1)

    def completed(self) -> FusedRun | None:
        """The run, done now; None: it fails."""
        for begin, end in self.sections:
            self.switch_models(begin)
            if self._run(begin, end) != end:
                return None
        return self.result()

    def result(self) -> FusedRun:
        """What the run has left."""
        telemetry, layout = self.parts.body.telemetry, self.parts.compiled.layout
        labels = (telemetry.labels, telemetry.sizes), (layout.labels, layout.sizes)
        return FusedRun(self.records, self.desired, self.period, *labels)

    def body(self) -> tuple[Body, Context]:
        """The true robot as it is now, and the context of its plant."""
        body = self.parts.plant.numbers()
        assert body is not None
        limits, floating, estimated = body.telemetry.traits
        traits = body.sensors.rule, self._draws, limits, int(floating), int(estimated), body.delay, body.reach
        return Body(body.memory, *traits), body.context

    def _run(self, begin: int, end: int) -> int:
        law, (body, context) = self.parts.compiled, self.body()
        steps, answer, note = pointers(law.answer, law.note, self.parts.law.n)
        own = answer, note, law.context.address, self.desired, self.records
        parts = body, self.known, steps, context.address, *own
        times = self.period, begin, end
        return _code(*parts, *times)(*parts, *times)


@cache
def pointers(answer: Callable[..., Any], note: Callable[..., Any], joints: int) -> tuple[Any, Any, Any]:
    """To plant and law, compiled where they were not before."""
    # Only here: without numba there is none.
    from space_robot_description.kernel.pointer import Pointer

    arguments, address, u = answer_example(joints, 1), np.int64(0), np.zeros(6 + joints)
    plant = Pointer(advance, address, u, 0.0, False)
    return plant, Pointer(answer, address, *arguments), Pointer(note, address, u, np.zeros(3), True)


_found: list[Callable[..., int]] = []


def _code(*arguments: Any) -> Callable[..., int]:
    """The machine code of the loop, which is the same for all plants and laws."""
    if not _found:
        _found.append(bound(run_ticks, *arguments))
    return _found[0]
