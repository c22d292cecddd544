"""Diagnostics of the controller node, the part that depends on the wall clock; without a timer, with its outputs."""

from __future__ import annotations

from time import perf_counter

from space_robot_control.laws.base import Law
from space_robot_control.laws.switching import Switching
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.diagnostics import Diagnostics
from space_robot_msgs_py.nodes.reasons import RecentCounts

DIAGNOSTICS_PERIOD = 1.0


class ControllerHealth:
    """Counts updates of the law and their duration; publishes at most once a second of the steady clock.

    Args:
        node: the publisher.
        law: of the node.
    """

    def __init__(self, node: GraphNode, law: Law) -> None:
        self._refusals, self._reasons, self._recent = node.refusals, node.reasons, RecentCounts()
        self._law, self._diagnostics = law, Diagnostics(node, "flight software")
        self._since, self._answers, self._total, self._longest = perf_counter(), 0, 0.0, 0.0

    def answered(self, stamp: int, begun: float) -> None:
        """Count the update for a state.

        Args:
            stamp: of the state [ns].
            begun: ``perf_counter()`` before the update.
        """
        now = perf_counter()
        self._answers += 1
        self._total += now - begun
        self._longest = max(self._longest, now - begun)
        if now - self._since >= DIAGNOSTICS_PERIOD:
            self._publish(stamp, now - self._since)
            self._since, self._answers, self._total, self._longest = now, 0, 0.0, 0.0

    def _publish(self, stamp: int, seconds: float) -> None:
        law, period = self._law, self._law.control_period
        late = self._longest > period
        answers: dict[str, float | str] = {
            "law": law.active if isinstance(law, Switching) else law.name,
            "answers_per_second": self._answers / seconds,
            "computation_mean_ms": 1e3 * self._total / self._answers,
            "computation_longest_ms": 1e3 * self._longest,
            "longest_over_period": self._longest / period,
        }
        answers |= {f"refused_{name}": float(count) for name, count in sorted(self._refusals.items())}
        answers |= self._reasons.values()
        warnings = [
            *(["slower than its period"] if late else []),
            *(f"refused {name}" for name in self._recent.grown(self._refusals)),
        ]
        statuses = [self._diagnostics.status("law", warnings, "within its period", answers)]
        if health := law.health():
            statuses.append(self._diagnostics.status("estimator", [], "learning", health))
        self._diagnostics.publish(stamp, statuses)
