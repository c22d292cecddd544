"""What depends on the wall clock: /diagnostics of the simulator, and the watchdog on silence."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.publisher import Publisher
from rclpy.subscription import Subscription

from space_robot_msgs_py.errors import SilenceError
from space_robot_msgs_py.interfaces import NANOSECONDS, PlantSample
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.diagnostics import Diagnostics
from space_robot_msgs_py.nodes.mismatches import mismatches
from space_robot_msgs_py.nodes.reasons import RecentCounts
from space_robot_msgs_py.topics import RUN_END, TABLE
from space_robot_sim.nodes.command_port import REPEATED

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
        commands: refused, missed, late and repeated ones, counted by reason.
        matched: publishers and subscriptions that others have to be matched with.
    """

    tick: int
    stamp: int
    period: int
    started: bool
    standing: bool
    unrecorded: bool
    sample: PlantSample | None
    commands: Mapping[str, int]
    matched: Sequence[Publisher | Subscription] = ()


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
        self._labels, self._place = tuple[str, ...](), slice(0)
        self._counts, self._refusals = RecentCounts(), RecentCounts()
        self._warned, self._said = False, set[str]()
        self._timer = node.create_timer(DIAGNOSTICS_PERIOD, self._on_timer, clock=self._clock)

    def count(self, sample: PlantSample) -> None:
        """Count a period that was run."""
        self._ran += 1
        telemetry = sample.telemetry
        if telemetry.labels is not self._labels:
            index = telemetry.labels.index("saturation")
            start = sum(telemetry.sizes[:index])
            self._labels, self._place = telemetry.labels, slice(start, start + telemetry.sizes[index])
        self._saturated += any(telemetry.data[self._place].tolist())

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
        lately = self._counts.grown({name: count for name, count in counts.items() if name != REPEATED})
        said_lately = ", ".join(f"{count} {name}" for name, count in lately.items())
        warnings = [f"commands were refused or missed: {said_lately}"] if said_lately else []
        warnings += [f"refused {name}" for name in self._refusals.grown(self._node.refusals)]
        pace = progress / DIAGNOSTICS_PERIOD
        commands: dict[str, float | str] = {
            "tick": status.tick,
            "ticks_per_second": pace,
            "realtime_factor": pace * status.period / NANOSECONDS,
            "silence_s": silence,
            **dict(sorted(counts.items())),
            **{f"refused_{name}": float(count) for name, count in sorted(self._node.refusals.items())},
            **self._node.reasons.values(),
        }
        telemetry = status.sample.telemetry if status.sample is not None else None
        residuals = {name: float(abs(telemetry[name]).max()) for name in RESIDUALS} if telemetry is not None else {}
        share = self._saturated / self._ran if self._ran else 0.0
        said = [*warnings, *self._strangers(status)]
        statuses = [
            self._diagnostics.status("commands", said, "every state was answered", commands),
            self._diagnostics.status("plant", [], "running", {"saturation_share": share, **residuals}),
        ]
        self._diagnostics.publish(status.stamp, statuses)

    def _strangers(self, status: SimulatorStatus) -> list[str]:
        found = [*dict.fromkeys(mismatches(self._node, status.matched))]
        for line in found:
            if line not in self._said:
                self._said.add(line)
                self._node.get_logger().warning(line)
        return [*self._rivals(), *found]

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
