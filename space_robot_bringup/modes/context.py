"""ROS contexts on a domain of their own: runs side by side do not hear each other."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import rclpy
from domain_coordinator import domain_id
from rclpy.context import Context
from rclpy.signals import SignalHandlerOptions

from space_robot_msgs_py.errors import SpecError

MAX_DOMAIN = 232


@contextmanager
def private_context() -> Iterator[Context]:
    """A context of its own: localhost only, on the domain of ROS_DOMAIN_ID or one no other run here uses."""
    with reserved_domain() as domain, local_context(domain) as context:
        yield context


@contextmanager
def local_context(domain: int, ros_arguments: Sequence[str] = ()) -> Iterator[Context]:
    """A context on a domain, localhost only unless ROS_AUTOMATIC_DISCOVERY_RANGE says otherwise.

    Args:
        domain: the one whose nodes hear each other.
        ros_arguments: ``--ros-args ...`` for rclpy.
    """
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    context = Context()
    try:
        rclpy.init(
            args=list(ros_arguments),
            context=context,
            domain_id=domain,
            signal_handler_options=SignalHandlerOptions.NO,
        )
    except RuntimeError as error:
        # What rcl cannot parse, a parameter file among it; the first line says what.
        raise SpecError(str(error).partition("\n")[0], key="--ros-args", value=list(ros_arguments)) from None
    try:
        yield context
    finally:
        context.try_shutdown()


@contextmanager
def reserved_domain() -> Iterator[int]:
    """ROS_DOMAIN_ID where it is set, else a domain that stays this run's own until the end of the block."""
    chosen = os.environ.get("ROS_DOMAIN_ID")
    if chosen is not None:
        yield domain_number(chosen)
        return
    reservation = domain_id()
    number = int(reservation.__enter__())
    try:
        yield number
    finally:
        # Left without an exception on purpose: the coordinator takes any OSError of the run for its own.
        reservation.__exit__(None, None, None)


def domain_number(text: str) -> int:
    """A ROS domain id, checked."""
    if not text.isdecimal() or int(text) > MAX_DOMAIN:
        raise SpecError("not a domain", key="ROS_DOMAIN_ID", value=text, accepted=f"0 to {MAX_DOMAIN}")
    return int(text)
