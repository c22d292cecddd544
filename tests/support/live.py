"""What a user does to the nodes of a running graph: services, parameters, transitions."""

from __future__ import annotations

from typing import Any

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from rcl_interfaces.srv import GetParameters, SetParametersAtomically
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool

from space_robot_msgs_py.interfaces import Tick
from space_robot_msgs_py.log.reader import LogReader
from tests.support.harness import RunningGraph


def call(robot: RunningGraph, service: Any, name: str, request: Any = None) -> Any:
    """The answer of a service."""
    client = robot.stranger.create_client(service, name)
    robot.spin_until(client.service_is_ready, f"service {name}")
    future = client.call_async(request or service.Request())
    robot.spin_until(future.done, f"an answer of {name}")
    return future.result()


def set_parameters(robot: RunningGraph, node: str, **values: Any) -> Any:
    """Set parameters of a node at once; ``__`` in a name is a dot."""
    parameters = [Parameter(name.replace("__", "."), value=v).to_parameter_msg() for name, v in values.items()]
    request = SetParametersAtomically.Request(parameters=parameters)
    return call(robot, SetParametersAtomically, f"{node}/set_parameters_atomically", request).result


def get_parameter(robot: RunningGraph, node: str, name: str) -> Any:
    """The value of a parameter."""
    answer = call(robot, GetParameters, f"{node}/get_parameters", GetParameters.Request(names=[name]))
    return Parameter.from_parameter_msg(_named(name, answer.values[0])).value


def _named(name: str, value: Any) -> Any:
    from rcl_interfaces.msg import Parameter as Message

    return Message(name=name, value=value)


def transit(robot: RunningGraph, node: str, transition: int) -> bool:
    """Ask a node for a transition of its life cycle."""
    request = ChangeState.Request(transition=Transition(id=transition))
    return bool(call(robot, ChangeState, f"{node}/change_state", request).success)


def halted(robot: RunningGraph) -> int:
    """Pause the run; the tick at which it stands."""
    call(robot, SetBool, "simulator/pause", SetBool.Request(data=True))
    return robot.await_answer()


def finished(robot: RunningGraph) -> list[Tick]:
    """Let the run go on to its end; its ticks."""
    call(robot, SetBool, "simulator/pause", SetBool.Request(data=False))
    robot.spin_until(lambda: robot.recorder.complete, "the end of the run")
    robot.recorder.finish("completed")
    return list(LogReader(robot.directory).ticks())


def events(ticks: list[Tick]) -> list[tuple[int, str, Any]]:
    """Tick, kind and content of all events of a log."""
    return [(i, e.kind, dict(e.content)) for i, tick in enumerate(ticks) for e in tick.output.events]
