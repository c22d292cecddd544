"""Replies that the middleware drops because their client is not discovered yet."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Any

import pytest

pytest.importorskip("rclpy")
from rclpy.exceptions import InvalidHandle

from space_robot_bringup.modes.context import private_context
from space_robot_bringup.modes.graph import make_executor
from space_robot_msgs_py.nodes import replies
from space_robot_msgs_py.nodes.base import GraphNode

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
DEADLINE = 60.0


class LateService:
    """A service whose client is discovered at a certain try, as rclpy shows it."""

    srv_name = "~/late"

    def __init__(self, heard_at: int) -> None:
        self.tries, self.sent = 0, list[Any]()
        self._heard_at = heard_at

    def send_response(self, response: Any, header: Any) -> None:
        self.tries += 1
        if self.tries < self._heard_at:
            warnings.warn(f"{replies.TIMED_OUT}: client will not receive response", RuntimeWarning, stacklevel=1)
        else:
            self.sent.append((response, header))


class GoneService(LateService):
    """One that is destroyed before its client is discovered."""

    def send_response(self, response: Any, header: Any) -> None:
        if self.tries:
            self.tries += 1
            raise InvalidHandle
        super().send_response(response, header)


@contextmanager
def spinning(monkeypatch: pytest.MonkeyPatch, service: LateService) -> Iterator[Any]:
    """A node that guards the service and sends again without a pause; gives what spins until a condition holds."""
    monkeypatch.setattr(replies, "RETRY_SECONDS", 0.001)
    with private_context() as context:
        node = GraphNode("node", context=context)
        node.replies.guard([service])
        executor = make_executor(context)
        executor.add_node(node)

        def until(condition: Any, what: str) -> None:
            end = monotonic() + DEADLINE
            while not condition():
                executor.spin_once(timeout_sec=0.02)
                assert monotonic() < end, f"waited {DEADLINE} s for {what}, saw {service.tries} tries"

        try:
            yield node, until
        finally:
            executor.shutdown()
            node.destroy_node()


@pytest.mark.parametrize("heard_at", [1, 2, 5])
def test_a_reply_is_sent_until_its_client_hears_it(monkeypatch: pytest.MonkeyPatch, heard_at: int) -> None:
    """However late the client is discovered, it gets its reply, once, and the warning of rclpy is not shown."""
    service = LateService(heard_at)
    with spinning(monkeypatch, service) as (_, until):
        service.send_response("reply", "header")
        until(lambda: service.sent, "the reply")
    assert service.sent == [("reply", "header")]
    assert service.tries == heard_at


def test_a_client_that_is_never_discovered_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """After the node's patience nothing is tried any more."""
    service = LateService(10**9)
    monkeypatch.setattr(replies, "PATIENCE_SECONDS", 0.0)
    with spinning(monkeypatch, service) as (node, until):
        service.send_response("reply", "header")
        until(lambda: not node.replies.waiting, "the end of patience")
    assert service.tries == 2


def test_a_service_that_is_gone_owes_no_reply(monkeypatch: pytest.MonkeyPatch) -> None:
    """A service destroyed in between (cleanup of a managed node) ends the tries without an error."""
    service = GoneService(10**9)
    with spinning(monkeypatch, service) as (node, until):
        service.send_response("reply", "header")
        until(lambda: not node.replies.waiting, "the reply to be dropped")
    assert service.tries == 2


def test_a_node_that_goes_sends_its_last_replies(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before a process ends, what it answered reaches its clients."""
    service = LateService(4)
    with spinning(monkeypatch, service) as (node, _):
        service.send_response("reply", "header")
        node.flush(DEADLINE)
        assert service.sent == [("reply", "header")]


def test_every_service_of_a_node_is_guarded() -> None:
    """Those of parameters, of the life cycle and of types are made by ROS itself, not by the node."""
    from space_robot_msgs_py.nodes.managed import ManagedNode

    class Managed(ManagedNode):
        def configure(self) -> None:
            pass

    with private_context() as context:
        node = Managed("node", context=context)
        names = {service.srv_name.rpartition("/")[2] for service in node.services}
        guarded = ["send_response" in vars(service) for service in node.services]
        node.destroy_node()
    assert {"list_parameters", "change_state", "get_state", "get_type_description"} <= names
    assert all(guarded)
