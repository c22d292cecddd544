"""A run as a ROS 2 graph in this process, with nodes of the caller beside, or in place of, those of the run."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from typing import Any

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import Experiment, Overrides
from space_robot_bringup.modes.hooks import roles_of
from space_robot_bringup.modes.run import judge_log
from space_robot_bringup.public.calls import for_python
from space_robot_bringup.public.given import given_experiment
from space_robot_bringup.public.result import Run
from space_robot_msgs_py.errors import SilenceError, SpecError
from space_robot_msgs_py.extras import install
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.paths import StrPath

SPIN_SECONDS = 0.02
TIMEOUT_SECONDS = 60.0


class OpenGraph:
    """The nodes of a run in a private context; they run while ``spin_until`` or ``finish`` spins them.

    Attributes:
        experiment: of the run.
        context: for nodes of your own, ``MyNode(context=graph.context)``; nothing outside of it hears them.
        nodes: those of the run by role: recorder, guidance, supervisor, controller, simulator.
    """

    def __init__(
        self, composition: Composition, directory: StrPath, context: Any, executor: Any, nodes: dict[str, Any]
    ) -> None:
        self.experiment: Experiment = composition.experiment
        self.context, self.nodes = context, nodes
        self._composition, self._directory, self._executor = composition, Path(directory), executor

    @property
    def tick(self) -> int:
        """The tick at which the simulator stands."""
        return int(self.nodes["simulator"].tick)

    def add_node(self, node: Any) -> None:
        """Let a node of your own take part; it is yours to destroy."""
        self._executor.add_node(node)

    def spin_until(self, condition: Callable[[], object], what: str, timeout: float = TIMEOUT_SECONDS) -> None:
        """Spin until a condition holds.

        Args:
            condition: asked between two callbacks.
            what: is awaited, for the error.
            timeout: [s] of the steady clock.

        Raises:
            SilenceError: it does not hold in time.
        """
        end = monotonic() + timeout
        while not condition():
            self._executor.spin_once(timeout_sec=SPIN_SECONDS)
            if monotonic() > end:
                raise SilenceError(f"waited {timeout:g} s for {what}", key="tick", value=self.tick)

    def finish(self, timeout: float = TIMEOUT_SECONDS) -> Run:
        """Spin to the end of the run, close its log and judge it.

        Args:
            timeout: [s] of the steady clock.

        Raises:
            SilenceError: it does not end in time: a node does not answer.
        """
        recorder, simulator = self.nodes["recorder"], self.nodes["simulator"]
        self.spin_until(lambda: simulator.end_reason and recorder.complete, "the end of the run", timeout)
        recorder.finish(simulator.end_reason)
        result = judge_log(self._directory, self._composition, simulator.end_reason, 0.0)
        return Run(self.experiment, result, LogReader(self._directory))


@contextmanager
def open_graph(
    experiment: StrPath | Experiment,
    overrides: Overrides | None = None,
    *,
    out: StrPath,
    without: Collection[str] = (),
) -> Iterator[OpenGraph]:
    """Open a lock-step graph; at the end of the block its nodes are gone and its log is closed.

    Args:
        experiment: see ``run``.
        overrides: see ``run``.
        out: run directory.
        without: roles whose nodes you bring yourself, ``["controller"]``.

    Raises:
        SpaceRobotError: the experiment cannot be used, there is no such role, or ROS 2 is not installed.
    """
    composition = compose(for_python(given_experiment)(experiment, overrides))
    roles = roles_of(supervised=composition.experiment.supervision is not None)
    if unknown := [role for role in without if role not in roles or role in ("recorder", "simulator")]:
        accepted = ", ".join(role for role in roles if role not in ("recorder", "simulator"))
        raise SpecError("no node that can be left out", key="without", value=unknown[0], accepted=accepted)
    try:
        # Only here: everything else works on a machine without ROS.
        from space_robot_bringup.modes.context import private_context
        from space_robot_bringup.modes.graph import LIGHT, make_executor, make_node
        from space_robot_msgs_py.nodes.managed import bring_up
    except ImportError as error:
        raise SpecError(f"a graph needs ROS 2 Jazzy ({error})", accepted=install("ros")) from None
    with private_context() as context:
        nodes: dict[str, Any] = {}
        executor = None
        try:
            for role in (role for role in roles if role not in without):
                nodes[role] = make_node(
                    role, composition, Path(out).absolute(), realtime=None, mode="graph", context=context, **LIGHT
                )
                bring_up([nodes[role]])
            executor = make_executor(context)
            for node in nodes.values():
                executor.add_node(node)
            yield OpenGraph(composition, Path(out).absolute(), context, executor, nodes)
        finally:
            if "recorder" in nodes:
                nodes["recorder"].finish("left")
            if executor is not None:
                executor.shutdown()
            for node in nodes.values():
                node.destroy_node()
