"""What depends on the wall clock: /diagnostics of the simulator, and the watchdog on silence."""

from __future__ import annotations

from typing import TYPE_CHECKING

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock
from rclpy.clock_type import ClockType

from space_robot_msgs_py.errors import SilenceError
from space_robot_msgs_py.topics import DIAGNOSTICS

if TYPE_CHECKING:
    from space_robot_sim.nodes.simulator import SimulatorNode

DIAGNOSTICS_PERIOD = 1.0


class SimulatorHealth:
    """Publishes counters once a second of the steady clock and ends a lock-step run nobody answers.

    Args:
        simulator: the node to watch.
        patience: how long the awaited command may take before the run ends [s].
    """

    def __init__(self, simulator: SimulatorNode, patience: float) -> None:
        self._simulator, self._patience = simulator, patience
        self._clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._publisher = simulator.create_publisher(DiagnosticArray, DIAGNOSTICS.name, 10)
        self._seen_tick, self._silent_since = -1, self._clock.now()
        self._timer = simulator.create_timer(DIAGNOSTICS_PERIOD, self._on_timer, clock=self._clock)

    def _on_timer(self) -> None:
        progress = self._simulator.tick - max(self._seen_tick, 0)
        standing = self._simulator.paused or not self._simulator.active or self._simulator.end_reason is not None
        if standing or self._simulator.tick != self._seen_tick:
            self._seen_tick, self._silent_since = self._simulator.tick, self._clock.now()
        silence = (self._clock.now() - self._silent_since).nanoseconds * 1e-9
        self._publish(progress, silence)
        if silence > self._patience:
            self._simulator.fail(self._silence(silence))

    def _silence(self, seconds: float) -> SilenceError:
        lasted, limit = f"{seconds:.0f} s of silence", f"within {self._patience:g} s"
        if not self._simulator.started:
            return SilenceError(
                "the run cannot start, the recorder does not hear every node",
                key="recorder/credit",
                value=lasted,
                accepted=f"recorder, guidance and controller on one domain {limit}",
            )
        return SilenceError(
            f"no command answers the state at {self._simulator.stamp} ns",
            key="base/wrench_command, joint_command",
            value=lasted,
            accepted=f"an answer {limit}; is a controller running?",
        )

    def _publish(self, progress: int, silence: float) -> None:
        counts = self._simulator.commands.counts
        status = DiagnosticStatus(name=f"{self._simulator.get_name()}: lock-step", hardware_id="plant")
        status.level = DiagnosticStatus.WARN if sum(counts.values()) else DiagnosticStatus.OK
        status.message = "commands were refused or missed" if sum(counts.values()) else "every state was answered"
        numbers = {
            "tick": self._simulator.tick,
            "ticks_per_second": progress / DIAGNOSTICS_PERIOD,
            "silence_s": silence,
        }
        status.values = [KeyValue(key=k, value=f"{v:g}") for k, v in (numbers | dict(sorted(counts.items()))).items()]
        message = DiagnosticArray(status=[status])
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(self._simulator.stamp, 1_000_000_000)
        self._publisher.publish(message)
