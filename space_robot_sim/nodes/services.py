"""What steers a run: the gate that holds it, and the services pause, step, reset."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger

from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_msgs_py.nodes.fill import fill
from space_robot_msgs_py.parameters import ParameterRow

STEP_COUNT = "step_count"
MAX_STEPS = 100_000


def step_count_row(count: int) -> ParameterRow:
    """The parameter that says how many steps ``~/step`` grants."""
    text = "steps that one call of ~/step grants while paused"
    return ParameterRow(STEP_COUNT, count, text, dynamic=True, lower=1, upper=MAX_STEPS)


def checked_count(value: Any) -> int:
    """A number of steps that was given during the run.

    Raises:
        SpecError: it is none, or beyond the bounds.
    """
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= MAX_STEPS:
        raise SpecError("not a number of steps", key=STEP_COUNT, value=value, accepted=f"1 to {MAX_STEPS}")
    return value


class Steerable(Protocol):
    """What the services steer."""

    @property
    def paused(self) -> bool:
        """True while only single steps advance the run."""

    @property
    def stamp(self) -> int:
        """Stamp of the current state [ns]."""

    def pause(self, paused: bool) -> None:
        """Stop at the next tick, or go on."""

    def step_once(self) -> None:
        """Take one step while paused."""

    def reset(self) -> None:
        """Start again.

        Raises:
            SpaceRobotError: it cannot.
        """


class StepGate:
    """Lets a run go on, or only by the steps that were granted while it is paused.

    Args:
        paused: begin so.
    """

    def __init__(self, *, paused: bool = False) -> None:
        self.pause(paused)

    @property
    def paused(self) -> bool:
        """True while only granted steps advance the run."""
        return self._granted is not None

    def pause(self, paused: bool) -> None:
        """Stop at the next tick, or go on; steps that were granted and not taken are forgotten."""
        self._granted: int | None = 0 if paused else None

    def grant(self) -> None:
        """One more step while paused."""
        self._granted = (self._granted or 0) + 1

    def take(self) -> bool:
        """True if the run may take a step now, which is then used up."""
        if self._granted == 0:
            return False
        if self._granted is not None:
            self._granted -= 1
        return True


class RunServices:
    """``~/pause`` (std_srvs/SetBool), ``~/step`` and ``~/reset`` (std_srvs/Trigger) of a node.

    Args:
        node: a node that is also Steerable.
        step_count: asked for how many steps ``~/step`` grants.
    """

    def __init__(self, node: Node, step_count: Callable[[], int] = lambda: 1) -> None:
        self._run: Steerable = node
        self._step_count = step_count
        node.create_service(SetBool, "~/pause", self._pause)
        node.create_service(Trigger, "~/step", self._step)
        node.create_service(Trigger, "~/reset", self._reset)

    def _pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self._run.pause(request.data)
        what = "paused" if request.data else "running"
        return fill(response, success=True, message=f"{what} at {self._run.stamp} ns")

    def _step(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        if not self._run.paused:
            return fill(response, success=False, message="the run is not paused: call ~/pause first")
        begin, count = self._run.stamp, self._step_count()
        for _ in range(count):
            self._run.step_once()
        granted = "one step" if count == 1 else f"{count} steps"
        return fill(response, success=True, message=f"{granted} granted; state at {begin} ns")

    def _reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        try:
            self._run.reset()
        except SpaceRobotError as error:
            return fill(response, success=False, message=error)
        return fill(response, success=True, message="at the initial state, 0 ns")
