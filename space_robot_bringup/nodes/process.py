"""One node of an experiment as one process: what ``--mode processes`` starts.

python -m space_robot_bringup.nodes.process simulator --experiment liu2023/fig08 --out runs/fig08
"""

from __future__ import annotations

import faulthandler
import os
import signal
import sys
import traceback
from argparse import Namespace
from collections.abc import Callable, Sequence
from contextlib import suppress
from math import inf
from pathlib import Path
from time import monotonic
from typing import Any, Never

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.context import Context

from space_robot_bringup.compose.composition import Composition, compose, compose_world
from space_robot_bringup.experiment.experiment import Experiment, load_experiment
from space_robot_bringup.modes.collector import collecting_new_garbage
from space_robot_bringup.modes.context import domain_number, local_context
from space_robot_bringup.modes.heartbeats import beating
from space_robot_bringup.modes.hooks import STANDBY, SUPERVISOR
from space_robot_bringup.modes.signals import Interrupted, RunStop
from space_robot_bringup.modes.tether import CLOSING_SECONDS, ChildEnd
from space_robot_bringup.nodes.arguments import Start, composed, parser, split_ros_arguments, start_from
from space_robot_bringup.nodes.graph_beats import GraphBeats
from space_robot_bringup.nodes.patience import Patience
from space_robot_bringup.nodes.waiting import WaitNotes
from space_robot_control.laws.policy import TYPED
from space_robot_description.fields import parameter_rows
from space_robot_description.kernel.choice import interpret
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.log.free_directory import checked_directory
from space_robot_msgs_py.log.run_directory import RunDirectory
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.managed import bring_up
from space_robot_msgs_py.nodes.parameters import given_at_start
from space_robot_msgs_py.topics import BASE_ODOM
from space_robot_sim.nodes.pacing import REALTIME
from space_robot_sim.nodes.recorder import RecorderNode
from space_robot_sim.nodes.services import STEP_COUNT

ACKNOWLEDGE_SECONDS = 5.0
# Where a process of the run died, it acknowledges nothing any more.
HURRIED_SECONDS = 0.2
PROGRESS_SECONDS = 0.2
POLL_SECONDS = 0.05
# They call no kernel, once the experiment is checked.
WITHOUT_KERNELS = ("recorder", "guidance")
# They make a law, which loads its kernels.
WITH_LAW = ("controller", STANDBY, SUPERVISOR)


def main(arguments: list[str] | None = None, name: str = "") -> int:
    """Run one node until the run ends.

    Args:
        arguments: of the command line, role first; None: those of this process.
        name: of the executable, for its help.

    Returns:
        0, 1 where the node failed, 2 on bad input.
    """
    own, ros = split_ros_arguments(sys.argv[1:] if arguments is None else arguments)
    options = parser(name).parse_args(own)
    # Else pydantic asks every installed distribution for plugins, a tenth of the start.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "1")
    if options.role in WITHOUT_KERNELS:
        interpret()
    with RunStop(signal.SIGINT, signal.SIGTERM) as stop:
        tether = ChildEnd(options.tether, stop.end)
        try:
            return _run(options, ros, stop, tether)
        except Interrupted as interruption:
            print(f"space-robot {options.role}: {interruption.reason}", file=sys.stderr)
            return 0
        except SpaceRobotError as error:
            print(f"space-robot {options.role}: {error}", file=sys.stderr)
            tether.tell(end=f"{options.role}: {error}")
            return 2


def _run(options: Namespace, ros: list[str], stop: RunStop, tether: ChildEnd) -> int:
    # As every ROS process: what starts several of us gives them one domain, or they meet on 0.
    domain = domain_number(os.environ.get("ROS_DOMAIN_ID", "0"))
    with local_context(domain, ros) as context:
        given = given_at_start(options.role, context)
        start = start_from(vars(options), given)
        # What started the nodes of a run has made its law already, and would have said what is wrong with it.
        trusted = options.tether is not None and options.role not in WITH_LAW
        composition = composed(start, given, _without_law if trusted else compose)
        if options.role == "recorder":
            # It runs no user code, and what it has begun to write is closed in order, from its first byte on.
            stop.ending()
            tether.grace = CLOSING_SECONDS
        node = _node(options, start, composition, context)
        patience = start.patience if start.autostart and start.patience else inf
        watches = [Patience(node, BASE_ODOM, patience).look] if options.role != "simulator" else []
        if options.tether is None:
            # Started by hand: what it does is in its log and not in that of a run.
            watches.append(WaitNotes(node).look)
            node.get_logger().info(_greeting(options.role, start, composition))
        if isinstance(node, RecorderNode):
            watches.append(_progress(node, composition.experiment.period, tether))
        if start.realtime:
            watches.append(beating(tether) if options.tether is not None else GraphBeats(node, options.role).look)
        code = _spin(node, stop, tether, watches, log=options.tether is None)
        if options.debug and node.failure is not None:
            traceback.print_exception(node.failure)
        return code


def _without_law(experiment: Experiment) -> Composition:
    return compose_world(experiment, TYPED)


def _node(options: Namespace, start: Start, composition: Composition, context: Context) -> GraphNode:
    # Here and below: it loads the nodes of all roles, and with the controller the compiler, unless this one needs none.
    from space_robot_bringup.modes.graph import make_node

    role, out = options.role, Path(start.out)
    if role == "recorder" and options.directory is None:
        checked_directory(out, overwrite=start.overwrite, key="out")
    extra: dict[str, Any] = {}
    if role == "simulator":
        extra = {"recorded": start.record, "patience": start.patience or inf, "step_count": start.step_count}
    # The simulator declares its own, which may change during the run.
    hidden = (REALTIME, STEP_COUNT) if role == "simulator" else (STEP_COUNT,)
    node = make_node(
        role,
        composition,
        out if options.directory is None else RunDirectory(out, inherited=options.directory),
        realtime=start.realtime or None,
        mode="processes",
        failover=start.failover,
        context=context,
        rows=[row for row in parameter_rows(start) if row.name not in hidden],
        overridable=True,
        **extra,
    )
    if start.autostart:
        bring_up([node])
    return node


def _greeting(role: str, start: Start, composition: Composition) -> str:
    """What a node that was started by hand says first."""
    pace = f"{start.realtime:g} x real time" if start.realtime else "lock-step"
    also = {"recorder": f", log in {start.out}", "controller": f", law {composition.experiment.controller.law}"}
    return f"started: {start.experiment}, {composition.experiment.duration:g} s, {pace}{also.get(role, '')}"


def _spin(node: GraphNode, stop: RunStop, tether: ChildEnd, watches: Sequence[Callable[[], None]], *, log: bool) -> int:
    from space_robot_bringup.modes.graph import drain, make_executor, raise_bug, spin

    executor = make_executor(node.context)
    executor.add_node(node)

    def poll() -> None:
        if (reason := stop.reason) is not None:
            # Fast DDS 2.14 may block for seconds in what is published when a reader was killed: the log comes first.
            node.end(reason, say=not tether.bereaved)
        for watch in watches:
            watch()

    # A timer, because the executor comes back from a spin only when it has nothing to do.
    node.create_timer(POLL_SECONDS, poll, clock=Clock(clock_type=ClockType.STEADY_TIME))
    try:
        with collecting_new_garbage():
            while node.end_reason is None:
                spin(executor, node)
    except Interrupted as interruption:
        # Out of a law that did not come back; asking for the reason tells that it was heard.
        node.end(stop.reason or interruption.reason, say=not tether.bereaved)
    stop.ending()
    reason = node.end_reason or "failed"
    tether.tell(end=reason)
    if isinstance(node, RecorderNode):
        tether.tell(logged=drain(executor, node, reason))
    node.say_end()
    if log:
        node.get_logger().info(f"the run has ended: {reason}")
    begun = monotonic()
    node.flush(ACKNOWLEDGE_SECONDS, lambda: tether.hurry and monotonic() - begun > HURRIED_SECONDS)
    if tether.bereaved:
        # Fast DDS 2.14 may crash as it lets go of shared memory that a killed process had in its hands. All is said by
        # now, and a crash that says nothing more is better than memory that stays.
        faulthandler.disable()
    # First the executor, which holds on to the node: only a node that is really gone takes its shared memory along.
    executor.shutdown()
    node.destroy_node()
    raise_bug(node)
    return 0 if node.failure is None else 1


def _progress(node: RecorderNode, period: int, tether: ChildEnd) -> Callable[[], None]:
    reported = -inf

    def tell() -> None:
        nonlocal reported
        if monotonic() - reported > PROGRESS_SECONDS:
            reported = monotonic()
            tether.tell(tick=node.written_until // period)

    return tell


def prepare(experiment: int) -> None:
    """Where nodes are forked: read the experiment and let its plant take a step, which loads kernels; no law is made.

    Args:
        experiment: descriptor of a file.
    """
    plant = _without_law(load_experiment(f"/dev/fd/{experiment}")).plant()
    plant.reset()
    plant.step(None)


def forked(*arguments: str) -> Never:
    """A node in a process that a nursery forked: in a session of its own, known to the system by its role.

    Ctrl-C in the terminal reaches only the process that started the run, which then ends its nodes in order.
    """
    os.setsid()
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with suppress(OSError):
        Path("/proc/self/comm").write_text(arguments[0])
    leave(main([*arguments]))


def leave(code: int) -> Never:
    """End the process without the interpreter's own end, which takes half a second and has nothing left to do."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


if __name__ == "__main__":
    leave(main())
