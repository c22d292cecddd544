"""Random sequences of all that steers a running graph: it always goes on to its end, and every log is well formed.

python -m tests.chaos.steering --cases 200 --seed 1
python -m tests.chaos.steering --seed 1 --only 17        # one sequence again

Pause, step, reset, transitions of the life cycle and changed parameters come in any order, each at once or when the one
before was answered, in lock-step and paced. Case k of a seed is always the same sequence. Paced runs have a clock too
slow to fire: periods end when the sequence says so.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool, Trigger

from space_robot_msgs_py.errors import ControlError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.nodes.managed import ManagedNode
from space_robot_sim.nodes.recorder import AHEAD_IN_ONE_PROCESS
from tests.support.harness import RunningGraph, running_graph
from tests.support.replays import replayed

STEPS, PERIOD = 24, 0.25
# A law that remembers: what it answers tells whether it was reset when it should.
OVERRIDES = (f"duration={STEPS * PERIOD}", "controller.gains.update=rls")
SLOW, SLOWER = 2e-3, 1e-3
TRANSITIONS = {
    "configure": Transition.TRANSITION_CONFIGURE,
    "activate": Transition.TRANSITION_ACTIVATE,
    "deactivate": Transition.TRANSITION_DEACTIVATE,
    "cleanup": Transition.TRANSITION_CLEANUP,
}
UP = ("configure", "activate")
STEERED = ("controller", "simulator")
# An action and how often it is drawn. "await" lets everything be answered, "spin" takes some events only.
WEIGHTS: dict[str, int] = {
    "pause": 4,
    "resume": 4,
    "step": 6,
    "reset": 5,
    "gain": 2,
    "pace": 1,
    "await": 6,
    "spin": 8,
    **{f"{transition} {node}": 1 for transition in ("configure", "cleanup") for node in STEERED},
    **{f"{transition} {node}": 2 for transition in ("activate", "deactivate") for node in STEERED},
}
MAX_CHARACTERS = 14


@dataclass(frozen=True)
class Case:
    """One sequence.

    Attributes:
        actions: of WEIGHTS, each with a number that it may use.
        paced: not in lock-step.
        ahead: how far the simulator may be ahead of the log [ticks].
    """

    actions: tuple[tuple[str, int], ...]
    paced: bool
    ahead: int


def make_case(seed: int, index: int) -> Case:
    """The sequence of that index."""
    random = Random(f"{seed}/{index}")
    names = random.choices([*WEIGHTS], [*WEIGHTS.values()], k=random.randint(3, MAX_CHARACTERS))
    numbers = [random.randint(1, 40) for _ in names]
    actions, paced = tuple(zip(names, numbers, strict=True)), random.random() < 0.4
    # Paced, the log may be a window behind.
    return Case(actions, paced, AHEAD_IN_ONE_PROCESS if paced else random.choice((0, 2, AHEAD_IN_ONE_PROCESS)))


@dataclass
class Driver:
    """Does the actions to a running graph."""

    robot: RunningGraph
    paced: bool
    clients: dict[str, Any] = field(default_factory=dict)
    asked: list[Any] = field(default_factory=list)

    def do(self, action: str, number: int) -> None:
        """Do one action; calls are sent and not awaited."""
        name, _, node = action.partition(" ")
        if name in TRANSITIONS:
            self.transit(node, name)
        elif name in ("pause", "resume"):
            self.call(SetBool, "simulator/pause", SetBool.Request(data=name == "pause"))
        elif name in ("step", "reset"):
            self.call(Trigger, f"simulator/{name}", Trigger.Request())
        elif name == "gain":
            self.set_parameter("controller", "gains.kappa", 0.5 + 0.02 * number)
        elif name == "pace":
            self.set_parameter("simulator", "realtime", SLOW if number % 2 else SLOWER)
        elif name == "await":
            self.settle()
        else:
            self.spin(number)

    def transit(self, node: str, name: str) -> None:
        """Ask for a transition."""
        request = ChangeState.Request(transition=Transition(id=TRANSITIONS[name]))
        self.call(ChangeState, f"{node}/change_state", request)

    def set_parameter(self, node: str, name: str, value: float) -> None:
        """Ask for another value."""
        request = SetParametersAtomically.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
        self.call(SetParametersAtomically, f"{node}/set_parameters_atomically", request)

    def call(self, kind: Any, name: str, request: Any) -> None:
        """Send a request, unless the service is not there, as those of a node that is not configured."""
        if name not in self.clients:
            self.clients[name] = self.robot.stranger.create_client(kind, name)
        if self.clients[name].service_is_ready():
            self.asked.append(self.clients[name].call_async(request))

    def spin(self, events: int) -> None:
        """Take so many events; paced, some periods end meanwhile."""
        for event in range(events):
            self.robot.executor.spin_once(timeout_sec=0.0)
            if self.paced and event % 8 == 7:
                self.end_period()

    def settle(self) -> None:
        """Take everything under way, as far as it goes in lock-step; paced, a period ends then."""
        for _ in range(3):
            self.robot.settle()
        if self.paced:
            self.end_period()

    def end_period(self) -> None:
        """What the clock would do."""
        if self.robot.simulator.configured:
            self.robot.simulator._on_period()

    def bring_to_end(self) -> None:
        """Make everything active and let it run: the run completes."""
        robot = self.robot
        self.settle()
        for role in STEERED:
            node = robot.nodes[role]
            assert isinstance(node, ManagedNode)
            if not node.configured:
                self.until(lambda node=node: node.configured, lambda role=role: self.transit(role, "configure"))
            if not node.active:
                self.until(lambda node=node: node.active, lambda role=role: self.transit(role, "activate"))
        self.do("resume", 0)
        self.settle()
        while self.paced and robot.simulator.end_reason is None:
            tick = robot.simulator.tick
            robot.spin_until(self.answered_or_over, f"an answer to tick {tick}")
            self.end_period()
            assert robot.simulator.tick > tick or robot.simulator.end_reason, f"the simulator stands at tick {tick}"
        robot.spin_until(lambda: robot.recorder.end_reason, "the end of the run")
        robot.settle()
        if not self.paced:
            robot.spin_until(lambda: robot.recorder.complete, "the last tick to be recorded")
        robot.recorder.finish(str(robot.recorder.end_reason))
        assert robot.recorder.end_reason == "completed" or (self.paced and self.law_gave_up()), (
            robot.recorder.end_reason
        )

    def answered_or_over(self) -> bool:
        """The state at which the run stands has its answer, or the run is over."""
        simulator = self.robot.simulator
        return simulator.end_reason is not None or (simulator.started and simulator.commands.answered)

    def law_gave_up(self) -> bool:
        """A paced run whose law was away for periods may end with the law's own error, which is the run's reason."""
        failure = self.robot.nodes["controller"].failure
        return isinstance(failure, ControlError) and self.robot.recorder.end_reason == f"controller: {failure}"

    def until(self, condition: Callable[[], bool], ask: Callable[[], None]) -> None:
        """Ask for a transition and wait for it."""
        ask()
        self.robot.spin_until(condition, "a transition")


def run_case(case: Case, folder: Path) -> None:
    """Do a sequence, bring the run to its end and look at its logs.

    Raises:
        AssertionError: something stands still, or a log is not what it should be.
    """
    with running_graph(folder / "run", *OVERRIDES, realtime=SLOWER if case.paced else None, services=True) as robot:
        robot.recorder._ahead = case.ahead
        driver = Driver(robot, case.paced)
        for action, number in case.actions:
            driver.do(action, number)
        driver.bring_to_end()
    check_logs(folder, case)


def check_logs(folder: Path, case: Case) -> None:
    """Every log has all ticks from 0 on, only the last of a run that was reset may lack something; replays agree."""
    logs = sorted(folder.iterdir(), key=lambda path: (len(path.name), path.name))
    assert [path.name for path in logs] == ["run", *(f"run_reset{k}" for k in range(1, len(logs)))]
    for path in logs:
        reader, last = LogReader(path), path is logs[-1]
        assert last or reader.end_reason == "reset", path.name
        completed = reader.end_reason == "completed"
        stamps = [stamp for stamp, _ in reader.stamps()]
        assert stamps == [round(k * PERIOD * 1e9) for k in range(len(stamps))], path.name
        complete = len(list(reader.ticks()))
        if completed:
            assert len(stamps) == STEPS + 1
        if not case.paced:
            assert complete >= len(stamps) - (not completed), (path.name, complete, len(stamps))
        for outcome in replayed(path).outcomes if complete else ():
            assert outcome.first is None, (path.name, outcome.against, outcome.first, outcome.remarks)


def failure_of(seed: int, index: int) -> str:
    """What goes wrong in a case; nothing: all is well."""
    case = make_case(seed, index)
    with TemporaryDirectory() as folder:
        try:
            run_case(case, Path(folder))
        except Exception as error:
            return f"case {index}: {type(error).__name__}: {error}\n  {case}"
    return ""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run so many cases; 1 where one fails."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, default=None, metavar="K", help="this case alone")
    options = parser.parse_args(arguments)
    indices = range(options.cases) if options.only is None else [options.only]
    failures = [failure for index in indices if (failure := failure_of(options.seed, index))]
    print(*failures, f"{len(indices)} cases, {len(failures)} failures", sep="\n")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
