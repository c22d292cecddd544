"""ROS contexts on a domain of their own: runs side by side do not hear each other."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from socket import AF_INET, SOCK_STREAM, socket

import rclpy
from domain_coordinator.impl import PORT_BASE
from rclpy.context import Context
from rclpy.signals import SignalHandlerOptions

from space_robot_msgs_py.errors import SpecError

MAX_DOMAIN = 232
# The ports of the domains above are those that outgoing connections take.
MAX_RESERVED = 100

# Where Fast DDS looks for profiles; other middlewares know none of them.
PROFILE_VARIABLES = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")
PROFILE_FILES = ("DEFAULT_FASTRTPS_PROFILES.xml", "DEFAULT_FASTDDS_PROFILES.xml")
DISCOVERY = Path(__file__).with_name("discovery.xml")

# Of this process: how many domains it has tried, and what holds those that it has.
_TURNS = count()
_HELD: list[socket] = []


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
    _announce_for_longer()
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


def _announce_for_longer() -> None:
    """Fast DDS reads our profile, unless it is given one or would find one in the working directory."""
    if not any(name in os.environ for name in PROFILE_VARIABLES) and not any(map(os.path.exists, PROFILE_FILES)):
        os.environ[PROFILE_VARIABLES[0]] = str(DISCOVERY)


@contextmanager
def reserved_domain() -> Iterator[int]:
    """ROS_DOMAIN_ID where it is set, else a domain that stays this run's own until the end of the block."""
    chosen = os.environ.get("ROS_DOMAIN_ID")
    if chosen is not None:
        yield domain_number(chosen)
        return
    number, holder = _reserve()
    _HELD.append(holder)
    try:
        yield number
    finally:
        _HELD.remove(holder)
        holder.close()


def reservations() -> tuple[int, ...]:
    """Descriptors that hold the domains of this process; a child that is given them (``pass_fds``) holds them, too.

    A domain is free when the last process of its run is gone: where the one that started them is killed, they may live
    for a moment longer, and nodes of the next run would hear them.
    """
    return tuple(holder.fileno() for holder in _HELD)


def _reserve() -> tuple[int, socket]:
    """A domain that no other run of this host has, and what holds it: by the convention of ``domain_coordinator``."""
    for _ in range(MAX_RESERVED):
        # One after the other, and not the first that is free: that would be the one which was left just now.
        number = (os.getpid() + next(_TURNS)) % MAX_RESERVED + 1
        holder = socket(AF_INET, SOCK_STREAM)
        try:
            holder.bind(("", PORT_BASE + number))
            return number, holder
        except OSError:
            holder.close()
    raise SpecError("every domain is in use", key="ROS_DOMAIN_ID", accepted=f"less than {MAX_RESERVED} runs at a time")


def domain_number(text: str) -> int:
    """A ROS domain id, checked."""
    if not text.isdecimal() or int(text) > MAX_DOMAIN:
        raise SpecError("not a domain", key="ROS_DOMAIN_ID", value=text, accepted=f"0 to {MAX_DOMAIN}")
    return int(text)
