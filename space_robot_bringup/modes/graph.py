"""The graph mode: all nodes in one private context and one executor."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from contextlib import redirect_stderr
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

from rclpy.context import Context
from rclpy.experimental import EventsExecutor

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.compose.live import live_reference
from space_robot_bringup.compose.parameters import rows_of
from space_robot_bringup.modes.collector import collecting_new_garbage
from space_robot_bringup.modes.context import private_context
from space_robot_bringup.modes.hooks import EFFORT_CONTROLLER, STANDBY, SUPERVISOR, Hooks, roles_of
from space_robot_bringup.modes.signals import Interrupted
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_msgs_py.log.free_directory import free_directory
from space_robot_msgs_py.log.run_directory import RunDirectory
from space_robot_msgs_py.log.writer import LogWriter
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.managed import bring_up
from space_robot_msgs_py.topics import WHEEL_MOMENTUM
from space_robot_sim.nodes.credit import AHEAD_BESIDE, AHEAD_IN_ONE_PROCESS, AHEAD_PACED
from space_robot_sim.nodes.recorder import RecorderNode
from space_robot_sim.nodes.tick_parts import MAX_LATE

if TYPE_CHECKING:
    from space_robot_control.nodes.controller import ControllerNode
    from space_robot_control.nodes.guidance import GuidanceNode
    from space_robot_sim.nodes.simulator import SimulatorNode
    from space_robot_supervisor.nodes.supervisor import SupervisorNode

NODES = {
    "guidance": "space_robot_control.nodes.guidance:GuidanceNode",
    "live_guidance": "space_robot_control.nodes.live_guidance:LiveGuidanceNode",
    "controller": "space_robot_control.nodes.controller:ControllerNode",
    "redundant_controller": "space_robot_control.nodes.redundant_controller:RedundantControllerNode",
    EFFORT_CONTROLLER: "space_robot_control.nodes.effort_controller:EffortControllerNode",
    "simulator": "space_robot_sim.nodes.simulator:SimulatorNode",
    SUPERVISOR: "space_robot_supervisor.nodes.supervisor:SupervisorNode",
}
# A finite timeout: without one this executor neither fires timers nor sleeps.
SPIN_TIMEOUT = 0.05
DRAIN_SECONDS = 5.0
QUIET_SECONDS = 0.2
# No parameter services and no /rosout on nodes that live for one run: half the start-up, no background traffic.
LIGHT = {"start_parameter_services": False, "enable_rosout": False}


@dataclass(frozen=True, eq=False, slots=True)
class Graph:
    """The nodes of one run."""

    recorder: RecorderNode
    guidance: GuidanceNode
    controller: ControllerNode
    simulator: SimulatorNode
    supervisor: SupervisorNode | None = None

    @property
    def nodes(self) -> tuple[GraphNode, ...]:
        """In the order they came to be: who listens first, who speaks last."""
        watching = () if self.supervisor is None else (self.supervisor,)
        return self.recorder, self.guidance, *watching, self.controller, self.simulator


def make_node(
    role: str,
    composition: Composition,
    directory: Path | RunDirectory,
    *,
    realtime: float | None,
    mode: str,
    failover: int = 0,
    **options: Any,
) -> GraphNode:
    """One node of the graph by its role, to be brought up: recorder, guidance, supervisor, controller or simulator.

    In place of the controller there may be an effort controller; with ``failover`` there is a standby beside it.

    Raises:
        SpecError: a supervisor in a run without supervision, or failover in one that is not paced.
    """
    check_failover(failover, realtime)
    experiment, names = composition.experiment, composition.joint_names
    options |= {"rows": [*options.pop("rows", ()), *rows_of(role, composition)]}
    if role in (*MANAGED, SUPERVISOR, STANDBY):
        options["steered"] = mode != "graph"
    timing: dict[str, Any] = {"period": experiment.period, "steps": experiment.steps}
    optional = {"optional": composition.optional_topics}
    # Paced, the clock goes on and waits for no log.
    ahead = AHEAD_IN_ONE_PROCESS if mode == "graph" else AHEAD_BESIDE
    if role == "recorder":
        ahead = ahead if realtime is None else AHEAD_PACED
        timing |= {"lossless": realtime is None, "ahead": ahead} | optional
        return RecorderNode(_writers(composition, directory, mode), names, **timing, **options)
    if role == "guidance":
        live = live_reference(composition)
        if live is not None:
            return _loaded("live_guidance")(live, names, **timing, **options)
        return _loaded(role)(composition.reference(), names, **timing, **options)
    if role == SUPERVISOR:
        return _supervisor_node(composition, lossless=realtime is None, **options)
    if role == EFFORT_CONTROLLER:
        return _loaded(role)(names, paced=realtime is not None, **options)
    if role in ("controller", STANDBY):
        supervised = composition.experiment.supervision is not None
        options |= {"supervised": supervised, "wheels": WHEEL_MOMENTUM in composition.optional_topics}
        if failover:
            options |= {"name": role, "period": experiment.period}
            return _loaded("redundant_controller")(composition.controller, names, **options)
        return _loaded("controller")(composition.controller, names, paced=realtime is not None, **options)
    timing |= optional | {"ahead": ahead, "obeys": composition.braked or composition.unloads, "failover": failover}
    return _loaded("simulator")(
        composition.plant, names, urdf=composition.nominal.urdf, realtime=realtime, **timing, **options
    )


def check_failover(failover: int, realtime: float | None) -> None:
    """Refuse what no second controller can do.

    Args:
        failover: periods of silence after which it takes over; 0: there is none.
        realtime: pace of the run; None: lock-step.

    Raises:
        SpecError: too many periods, or a run that waits for its controller.
    """
    if not 0 <= failover <= MAX_LATE:
        raise SpecError("not a number of periods", key="failover", value=failover, accepted=f"1 to {MAX_LATE}")
    if failover and not realtime:
        raise SpecError("lock-step waits for its controller", key="failover", value=failover, accepted="with realtime")


def _supervisor_node(composition: Composition, *, lossless: bool, **options: Any) -> GraphNode:
    supervisor = composition.supervisor()
    if supervisor is None:
        raise SpecError("this run has none", key="supervision", accepted="a shipped table, or a run without this node")
    return _loaded(SUPERVISOR)(
        # Of a composition that could make one it can be made again.
        lambda: composition.supervisor() or supervisor,
        composition.joint_names,
        period=composition.experiment.period,
        optional=composition.optional_topics,
        lossless=lossless,
        telemetry=supervisor.reads_telemetry,
        monitored=supervisor.reads_counts,
        **options,
    )


def _loaded(node: str) -> Callable[..., GraphNode]:
    """The class of a node; a process of one node loads no others."""
    module, _, name = NODES[node].partition(":")
    found: Callable[..., GraphNode] = getattr(import_module(module), name)
    return found


def _writers(composition: Composition, directory: Path | RunDirectory, mode: str) -> Callable[[int], LogWriter]:
    path = directory.path if isinstance(directory, RunDirectory) else directory

    def open_writer(index: int) -> LogWriter:
        # Those of a run before that was moved or deleted may still be there.
        place = directory if index == 0 else free_directory(path.with_name(f"{path.name}_reset{index}"))
        return LogWriter(place, composition.header, custom={"mode": mode})

    return open_writer


MANAGED = ("controller", "simulator")


def make_graph(
    composition: Composition, directory: Path | RunDirectory, *, context: Context, realtime: float | None = None
) -> Graph:
    """All nodes of a run in one context, brought up and ready to spin.

    Raises:
        Exception: what a node failed with; no node is left, and the log, if there is one, says so.
    """
    made: dict[str, Any] = {}
    try:
        for role in roles_of(supervised=composition.experiment.supervision is not None):
            options: dict[str, Any] = {"mode": "graph", "context": context, **LIGHT}
            made[role] = make_node(role, composition, directory, realtime=realtime, **options)
            # One after the other: a command then reaches the recorder, whose subscriptions are older, before the
            # simulator, and what acted is in the log when the process is killed in the next instant.
            bring_up([made[role]])
    except BaseException as error:
        if "recorder" in made:
            made["recorder"].finish(error.reason if isinstance(error, Interrupted) else f"not started: {error}")
        _destroy(made.values())
        raise
    return Graph(**made)


def _destroy(nodes: Iterable[GraphNode]) -> None:
    for node in nodes:
        node.destroy_node()


def run_graph(composition: Composition, directory: Path | RunDirectory, *, realtime: float | None, hooks: Hooks) -> str:
    """Execute a run in graph mode and return the reason of its end."""
    with private_context() as context:
        graph = make_graph(composition, directory, context=context, realtime=realtime)
        try:
            return spin_graph(graph, context, hooks)
        finally:
            # Whatever happened above, what was recorded is closed and readable.
            graph.recorder.finish(graph.simulator.end_reason or "failed")
            _destroy(graph.nodes)


def spin_graph(graph: Graph, context: Context, hooks: Hooks) -> str:
    """Spin until the run ends by itself or ``hooks.stop`` ends it; everything under way is recorded first."""
    executor = make_executor(context)
    for node in graph.nodes:
        executor.add_node(node)

    def stopped() -> bool:
        reason = hooks.stop()
        if reason is not None:
            graph.simulator.end(reason)
        return reason is not None

    def on_tick(tick: int) -> None:
        # The executor looks at its timeout only when it has nothing to do, which in a fast run is never.
        hooks.on_tick(tick)
        stopped()

    graph.simulator.on_tick = on_tick
    try:
        with collecting_new_garbage():
            while graph.recorder.end_reason is None and not stopped():
                spin(executor, graph.recorder)
    except Interrupted:
        # Out of a law that did not come back; asking for the reason tells that it was heard.
        stopped()
    reason = drain(executor, graph.recorder, graph.simulator.end_reason or graph.recorder.end_reason or "failed")
    for node in graph.nodes:
        raise_bug(node)
        if node.failure is not None:
            hooks.on_failure(node.failure)
    return reason


def raise_bug(node: GraphNode) -> None:
    """What stopped a node on purpose is in the reason of the end; anything else is a bug and keeps its traceback."""
    if node.failure is not None and not isinstance(node.failure, SpaceRobotError):
        raise node.failure


def make_executor(context: Context) -> EventsExecutor:
    """The executor all modes use; the single-threaded one is four times slower."""
    # It enables faulthandler, which wants a stderr that is a file; in a notebook or under capture it is none.
    with redirect_stderr(sys.__stderr__ or sys.stderr):
        return EventsExecutor(context=context)


def spin(executor: Any, node: GraphNode) -> None:
    """Spin until the node hears the end of the run, at most ``SPIN_TIMEOUT``.

    The executor's own loop: stepping it from Python costs a third of the ticks per second.
    """
    executor.spin_until_future_complete(node.over, timeout_sec=SPIN_TIMEOUT)


def drain(executor: Any, recorder: RecorderNode, reason: str) -> str:
    """Let the recorder hear what is still under way, then close its log; returns the reason, see ``finish``."""
    heard, quiet_since = recorder.heard, monotonic()
    deadline = quiet_since + DRAIN_SECONDS
    while not recorder.complete and recorder.failure is None and monotonic() < deadline:
        executor.spin_once(timeout_sec=SPIN_TIMEOUT)
        if recorder.heard != heard:
            heard, quiet_since = recorder.heard, monotonic()
        elif monotonic() - quiet_since > QUIET_SECONDS and (
            reason != "completed" or not (recorder.lossless or recorder.awaits)
        ):
            break
    reason = recorder.finish(reason)
    executor.shutdown()
    return reason
