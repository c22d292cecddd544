"""What depends on the wall clock: /diagnostics of the simulator, and the watchdog on silence."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from rclpy.clock import Clock
from rclpy.clock_type import ClockType

from space_robot_msgs_py.errors import SilenceError
from space_robot_msgs_py.interfaces import NANOSECONDS, PlantSample
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.diagnostics import Diagnostics
from space_robot_msgs_py.topics import RUN_END, TABLE

DIAGNOSTICS_PERIOD = 1.0
# What one node alone publishes in a run.
WATCHED = tuple(topic for topic in TABLE if topic.kind != "tool" and topic is not RUN_END)
RESIDUALS = ("momentum_residual", "energy_residual", "quaternion_residual")


class SimulatorStatus(NamedTuple):
    """What the simulator says of itself.

    Attributes:
        tick: of the state that waits for its answer.
        stamp: of that state [ns].
        period: control period [ns].
        started: the first state was published.
        standing: time may not pass: paused, not active, or at the end of the run.
        unrecorded: the state has its answer, but the recorder has not written the ticks before.
        sample: the newest of the plant.
        commands: refused, missed and late ones, counted by reason.
    """

    tick: int
    stamp: int
    period: int
    started: bool
    standing: bool
    unrecorded: bool
    sample: PlantSample | None
    commands: Mapping[str, int]


class SimulatorHealth:
    """Publishes counters once a second of the steady clock and ends a lock-step run without answers.

    Args:
        node: the node to watch.
        status: what it says of itself now.
        patience: how long the awaited command may take before the run ends [s].
    """

    def __init__(self, node: GraphNode, status: Callable[[], SimulatorStatus], patience: float) -> None:
        self._node, self._status, self._patience = node, status, patience
        self._clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._diagnostics = Diagnostics(node, "plant")
        self._seen_tick, self._silent_since = -1, self._clock.now()
        self._ran = self._saturated = 0
        self._warned = False
        self._timer = node.create_timer(DIAGNOSTICS_PERIOD, self._on_timer, clock=self._clock)

    def count(self, sample: PlantSample) -> None:
        """Count a period that was run."""
        self._ran += 1
        self._saturated += bool(sample.telemetry["saturation"].any())

    def _on_timer(self) -> None:
        status = self._status()
        progress = status.tick - max(self._seen_tick, 0)
        if status.standing or status.tick != self._seen_tick:
            self._seen_tick, self._silent_since = status.tick, self._clock.now()
        silence = (self._clock.now() - self._silent_since).nanoseconds * 1e-9
        self._publish(status, max(progress, 0), silence)
        if silence > self._patience:
            self._node.fail(self._silence(status, silence))

    def _silence(self, status: SimulatorStatus, seconds: float) -> SilenceError:
        lasted, limit = f"{seconds:.0f} s of silence", f"within {self._patience:g} s"
        if not status.started:
            return SilenceError(
                "the run cannot start, the recorder does not hear every node",
                key="recorder/credit",
                value=lasted,
                accepted=f"recorder, guidance and controller on one domain {limit}",
            )
        if status.unrecorded:
            return SilenceError(
                f"the ticks before {status.stamp} ns are not recorded",
                key="recorder/credit",
                value=lasted,
                accepted=f"a recorder that writes {limit}; is it running?",
            )
        return SilenceError(
            f"no command answers the state at {status.stamp} ns",
            key="base/wrench_command, joint_command",
            value=lasted,
            accepted=f"an answer {limit}; is a controller running?",
        )

    def _publish(self, status: SimulatorStatus, progress: int, silence: float) -> None:
        counts = status.commands
        warnings = ["commands were refused or missed"] if sum(counts.values()) else []
        warnings += [f"refused {name}" for name in sorted(self._node.refusals)]
        pace = progress / DIAGNOSTICS_PERIOD
        commands = {
            "tick": status.tick,
            "ticks_per_second": pace,
            "realtime_factor": pace * status.period / NANOSECONDS,
            "silence_s": silence,
            **dict(sorted(counts.items())),
            **{f"refused_{name}": float(count) for name, count in sorted(self._node.refusals.items())},
        }
        telemetry = status.sample.telemetry if status.sample is not None else None
        residuals = {name: float(abs(telemetry[name]).max()) for name in RESIDUALS} if telemetry is not None else {}
        share = self._saturated / self._ran if self._ran else 0.0
        self._diagnostics.publish(
            status.stamp,
            [
                self._diagnostics.status("commands", warnings + self._rivals(), "every state was answered", commands),
                self._diagnostics.status("plant", [], "running", {"saturation_share": share, **residuals}),
            ],
        )

    def _rivals(self) -> list[str]:
        """Topics that more than one node publishes, with the nodes: one of them may be a stranger."""
        found = []
        for topic in WATCHED:
            number = self._node.count_publishers(topic.name)
            if number > 1:
                names = self._node.publishing_nodes(topic)
                found.append(f"{number} publishers of {topic.name} ({', '.join(names)})")
        if found and not self._warned:
            self._warned = True
            self._node.get_logger().warning(f"{', '.join(found)}: of a command the first valid answer to a state acts")
        return found
