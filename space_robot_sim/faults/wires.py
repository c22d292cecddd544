"""What arrives of what is sent, at both ends of a link: a function of the plan, so that no end waits for the other."""

from __future__ import annotations

from dataclasses import replace
from typing import Generic, Protocol, TypeVar

from space_robot_msgs_py.interfaces import Command, Reference, RobotState
from space_robot_sim.faults.links import ControllerRestarted, ControllerSilent, LinkFault, LinkName
from space_robot_sim.faults.plan import FaultPlan


class Stamped(Protocol):
    """A message."""

    @property
    def stamp(self) -> int:
        """[ns]."""


M = TypeVar("M", bound=Stamped)


class Wire(Generic[M]):
    """One link with its faults.

    Args:
        plan: of the run.
        topic: which link.
    """

    def __init__(self, plan: FaultPlan, topic: LinkName) -> None:
        self._plan = plan
        self._planned = [one for one in plan.of(LinkFault) if getattr(one.fault, "topic", "") == topic]
        self.reset()

    @property
    def faulty(self) -> bool:
        """There are some."""
        return bool(self._planned)

    def reset(self) -> None:
        """Forget all messages."""
        self._under_way: list[tuple[int, M]] = []
        self._newest = -1

    def carry(self, tick: int, message: M | None) -> M | None:
        """Send a message at a tick (None: nothing is sent); the newest that arrives and is news, or None.

        Call once per tick, in order.
        """
        if message is not None:
            self._under_way += [(tick + periods, message) for periods in self._arrivals(tick)]
        here = [sent for due, sent in self._under_way if due <= tick and sent.stamp > self._newest]
        self._under_way = [(due, sent) for due, sent in self._under_way if due > tick]
        if not here:
            return None
        newest = max(here, key=lambda sent: sent.stamp)
        self._newest = newest.stamp
        return newest

    def _arrivals(self, tick: int) -> list[int]:
        """After how many periods a message sent at this tick arrives, each time it does."""
        found = [0]
        for one in self._planned:
            if one.acts(tick):
                assert isinstance(one.fault, LinkFault)
                more = one.fault.arrivals(self._plan.rng(one, tick))
                found = [before + after for before in found for after in more]
        return found


class CommandWire(Wire[Command]):
    """From the controller to the plant.

    Args:
        plan: of the run.
    """

    def __init__(self, plan: FaultPlan) -> None:
        super().__init__(plan, "command")


class ControllerInbox:
    """What the controller hears of states and references, and when it begins anew; see ``Law.inbox``.

    What has not arrived is replaced by the newest that has, under the stamp of the tick: flight software goes on with
    what it knows. The first of a run always arrives.

    Args:
        plan: of the run.
    """

    def __init__(self, plan: FaultPlan) -> None:
        self._period = plan.period
        self._states: Wire[RobotState] = Wire(plan, "state")
        self._references: Wire[Reference] = Wire(plan, "reference")
        restarts = [one.first for one in plan.of(ControllerRestarted)]
        self._restarts = {*restarts, *(one.end for one in plan.of(ControllerSilent))}
        self.reset()

    def reset(self) -> None:
        """Forget all messages, as at the start of a run."""
        self._last = -1
        self._states.reset()
        self._references.reset()
        self._state: RobotState | None = None
        self._reference: Reference | None = None

    def hear(self, state: RobotState, reference: Reference) -> tuple[RobotState, Reference, bool]:
        """What the controller has at this tick, and whether it has just begun anew; see ``Inbox.hear``."""
        tick, stamp = state.stamp // self._period, state.stamp
        if stamp <= self._last:
            self.reset()
        self._last = stamp
        self._state = self._states.carry(tick, state) or self._state or state
        self._reference = self._references.carry(tick, reference) or self._reference or reference
        now = self._state if self._state is state else replace(self._state, stamp=stamp)
        wanted = self._reference if self._reference is reference else replace(self._reference, stamp=stamp)
        return now, wanted, tick in self._restarts
