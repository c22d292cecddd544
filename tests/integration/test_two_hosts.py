"""Simulator and recorder on one host, guidance and controller on another, and the cable between them is pulled."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import monotonic, sleep

import numpy as np
import pytest

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.codec.codecs import TickCodec
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.log.reader import LogReader
from tests.support.follow import await_ticks, ended, ticks_in
from tests.support.forks import Fork
from tests.support.hosts import NOT_SEEN, SEEN, look_for_simulator, main_on

pytest.importorskip("rclpy")
pytestmark = [pytest.mark.ros, pytest.mark.slow, pytest.mark.netns, pytest.mark.xdist_group("hosts")]

ADDRESSES = {"onboard": "10.231.77.1", "ground": "10.231.77.2"}
NODE = "space_robot_bringup.nodes.process"
ROLES = {"recorder": "onboard", "simulator": "onboard", "guidance": "ground", "controller": "ground"}
CUT_SECONDS = 3.0
DEADLINE = 120.0
PACE, PERIOD = 2.0, 0.25
# Hosts share no memory, the two namespaces of this machine would. What is heard by default is to be seen.
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "ROS_AUTOMATIC_DISCOVERY_RANGE"}
ENVIRONMENT |= {"ROS_DOMAIN_ID": "7", "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4"}
# A law that needs no compiler.
EXPERIMENT, OVERRIDES = "liu2023/fig11", ["controller.law=computed_torque", "plant.hold=zero"]


@dataclass
class TwoHosts:
    """Two network namespaces with a cable between them."""

    onboard: str
    ground: str

    def start(self, role: str, run: Path, *options: str, named: bool = True) -> Fork:
        """One node on the host where it belongs; ``named``: it knows the other host by its address."""
        host = ROLES[role]
        (other,) = (address for name, address in ADDRESSES.items() if name != host)
        overrides = [word for override in OVERRIDES for word in ("--set", override)]
        return Fork(
            main_on,
            *(getattr(self, host), NODE, role, "--experiment", EXPERIMENT, "--out", str(run), *overrides, *options),
            environment=ENVIRONMENT | ({"ROS_STATIC_PEERS": other} if named else {}),
        )

    def sees_simulator(self, host: str, seconds: float) -> bool:
        """Whether a node with default settings sees the simulator from that host, within so many seconds."""
        with ended([Fork(look_for_simulator, getattr(self, host), seconds, environment=ENVIRONMENT)]) as (scout,):
            assert scout.wait(seconds + DEADLINE) in (SEEN, NOT_SEEN), scout.communicate()[1]
            return scout.returncode == SEEN

    def cable(self, state: str) -> None:
        """``up`` or ``down``."""
        ip("netns", "exec", self.ground, "ip", "link", "set", "cable", state)


def ip(*arguments: str) -> str:
    """Configure the network, or look at it; skips the test where that is not permitted."""
    if shutil.which("ip") is None:
        pytest.skip("ip (iproute2) is not installed")
    done = subprocess.run(["ip", *arguments], capture_output=True, text=True, check=False)
    if any(words in done.stderr for words in ("not permitted", "Permission denied", "not supported")):
        pytest.skip(f"network namespaces are not permitted here: ip {' '.join(arguments)}: {done.stderr.strip()}")
    assert done.returncode == 0, done.stderr
    return done.stdout


def await_running(namespace: str) -> None:
    """The kernel tells of a new link up to a second late, and the middleware passes over an interface that is down."""
    until = monotonic() + DEADLINE
    while "LOWER_UP" not in (shown := ip("netns", "exec", namespace, "ip", "-o", "link", "show", "cable")):
        assert monotonic() < until, f"waited {DEADLINE} s for the link of {namespace}: {shown}"
        sleep(0.02)


@pytest.fixture
def hosts() -> Iterator[TwoHosts]:
    """Both up and connected before any node starts: the middleware looks at the interfaces once."""
    names = {host: f"space_robot_{host}_{os.getpid()}" for host in ADDRESSES}
    try:
        for name in names.values():
            ip("netns", "add", name)
        one, other = (("name", "cable", "netns", name) for name in names.values())
        ip("link", "add", *one, "type", "veth", "peer", *other)
        for host, address in ADDRESSES.items():
            inside = ("netns", "exec", names[host], "ip")
            ip(*inside, "address", "add", f"{address}/24", "dev", "cable")
            ip(*inside, "link", "set", "cable", "up")
            ip(*inside, "link", "set", "lo", "up")
        for name in names.values():
            await_running(name)
        yield TwoHosts(**names)
    finally:
        for name in names.values():
            subprocess.run(["ip", "netns", "delete", name], capture_output=True, check=False)


def run_with_outage(hosts: TwoHosts, run: Path, ticks: int, *options: str) -> tuple[int, int]:
    """Run on both hosts and pull the cable for some seconds when the log has so many ticks.

    Returns the ticks in the log amid the time without a link and at its end.
    """
    children = {role: hosts.start(role, run, *options) for role in ROLES}
    with ended([*children.values()]):
        await_ticks(run, ticks, children["recorder"], DEADLINE)
        hosts.cable("down")
        sleep(CUT_SECONDS / 2)
        amid = ticks_in(run)
        sleep(CUT_SECONDS / 2)
        late = ticks_in(run)
        hosts.cable("up")
        said = {role: child.communicate(timeout=DEADLINE)[1] for role, child in children.items()}
    assert [child.returncode for child in children.values()] == [0, 0, 0, 0], said
    assert LogReader(run).end_reason == "completed"
    return amid, late


def test_lock_step_waits_for_the_link_and_loses_nothing(hosts: TwoHosts, tmp_path: Path) -> None:
    """A run stands still while the link is down and leaves the same file as the loop without ROS."""
    long = "duration=1000.0"
    amid, late = run_with_outage(hosts, tmp_path / "run", 100, "--set", long)
    assert amid == late
    run_experiment(load_experiment(EXPERIMENT, [*OVERRIDES, long]), tmp_path / "alone", mode="headless")
    assert (tmp_path / "run" / "run_0.mcap").read_bytes() == (tmp_path / "alone" / "alone_0.mcap").read_bytes()


def test_a_paced_run_holds_while_the_link_is_down_and_recovers(hosts: TwoHosts, tmp_path: Path) -> None:
    """Without commands the motors get the hold, zero here; with the link they come back and the robot follows again."""
    run_with_outage(hosts, tmp_path / "run", 40, "--realtime", str(PACE), "--set", "duration=60.0")
    log = LogReader(tmp_path / "run")
    codec = TickCodec(log.header.joint_names)
    rows = [parts for _, parts in log.stamps()]
    states = [codec.state.decode([parts[topic.name] for topic in codec.state.topics]) for parts in rows]
    wanted = [codec.reference.decode([parts[topic.name] for topic in codec.reference.topics]) for parts in rows]
    effort = np.array([state.effort for state in states])
    begin, end = _longest_rest(effort)
    assert begin > 10
    assert end - begin >= 0.9 * CUT_SECONDS * PACE / PERIOD
    after = effort[end + 1 :]
    assert len(after) > 40
    assert np.mean(np.abs(after).max(axis=1) > 0.0) > 0.9
    error = np.abs(np.array([one.q[7:] - other.q[7:] for one, other in zip(states, wanted, strict=True)])).max(axis=1)
    assert error[-20:].max() < 2 * error[: begin - 2].max() < 0.5 * error[end]


def test_hosts_that_were_not_named_do_not_hear_each_other(hosts: TwoHosts, tmp_path: Path) -> None:
    """On one domain, with a link, a node is seen on its own host only: discovery is local unless set otherwise."""
    with ended([hosts.start("simulator", tmp_path / "run", named=False)]) as (simulator,):
        assert hosts.sees_simulator("onboard", DEADLINE)
        assert not hosts.sees_simulator("ground", CUT_SECONDS)
        simulator.send_signal(signal.SIGTERM)
        said = simulator.communicate(timeout=DEADLINE)[1]
    assert simulator.returncode == 0, said


def _longest_rest(effort: Vector) -> tuple[int, int]:
    """First tick and the one behind the last of the longest time in which no motor did anything."""
    working = np.flatnonzero(np.abs(effort).max(axis=1) > 0.0)
    longest = int(np.argmax(np.diff(working)))
    return int(working[longest]) + 1, int(working[longest + 1])
