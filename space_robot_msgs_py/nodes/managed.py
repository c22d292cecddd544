"""A node with a ROS life cycle: configure builds, activate starts, deactivate holds, cleanup frees."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterable
from typing import Any

from rclpy.lifecycle import LifecycleNodeMixin, LifecycleState, TransitionCallbackReturn

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.fill import fill

WITHDRAW_SECONDS = 1.0


class ManagedNode(GraphNode, LifecycleNodeMixin):  # type: ignore[misc]
    """A GraphNode in the life cycle of ROS; until it is configured it only knows how the run ends.

    A transition that fails leaves the node where it was and says why. Its services are ``~/change_state`` and what else
    ``ros2 lifecycle`` uses. Nothing of this costs anything per tick: publishers are plain ones, and an inactive node
    does not speak because it is not asked to.

    Attributes:
        configured: between configure and cleanup.
        active: between activate and deactivate.

    Args:
        name: node name.
        steered: offer the services; without them only this process can bring it up.
        options: see GraphNode.
    """

    def __init__(self, name: str, *, steered: bool = True, **options: Any) -> None:
        super().__init__(name, **options)
        LifecycleNodeMixin.__init__(self, enable_communication_interface=steered)
        self.configured = self.active = False
        self._refusal: Exception | None = None
        if steered:
            _refuse_politely(self._service_change_state)
            self.replies.guard(self.services)
        self.keep()

    def keep(self) -> None:
        """What there is of publishers, subscriptions, services and timers now stays through every cleanup."""
        self._permanent = {id(handle) for handle in self._handles()}

    def keep_too(self, *handles: Any) -> None:
        """These stay through every cleanup as well, though they were made later."""
        self._permanent |= {id(handle) for handle in handles}

    @abstractmethod
    def configure(self) -> None:
        """Build everything; nothing is published but what is latched."""

    def activate(self) -> None:
        """Start, or go on after a hold."""

    def cleanup(self) -> None:
        """Free what ``configure`` built; its publishers, subscriptions, services and timers are gone."""

    def retune(self, changes: dict[str, Any]) -> None:
        """What ``tune`` does in a node that is configured.

        Raises:
            SpecError: the reason why not.
        """
        super().tune(changes)

    def tune(self, changes: dict[str, Any]) -> None:
        """Take over parameters that were set during the run, all or none.

        Raises:
            SpecError: the reason why not; a node that is not configured takes none.
        """
        if not self.configured:
            raise SpecError("the node is not configured", key=", ".join(changes))
        self.retune(changes)

    def must(self, transition: Callable[[], TransitionCallbackReturn]) -> None:
        """Do a transition, such as ``trigger_configure``.

        Raises:
            Exception: what it failed with.
        """
        self._refusal = None
        if transition() != TransitionCallbackReturn.SUCCESS and self._refusal is not None:
            raise self._refusal

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Build, or leave nothing behind."""
        result = self._try(self.configure)
        if result != TransitionCallbackReturn.SUCCESS:
            self._withdraw()
        self.configured = result == TransitionCallbackReturn.SUCCESS
        return result

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Start."""
        self.active = True
        return self._try(self.activate)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Hold: nothing is done until it is activated again."""
        self.active = False
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Free."""
        self.configured = False
        return self._try(self._withdraw, self.cleanup)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Shutting a node down ends the run."""
        self.active = False
        self.end(f"{self.get_name()}: shut down")
        return TransitionCallbackReturn.SUCCESS

    def destroy_node(self) -> None:
        """Leave nothing in the graph, where rclpy keeps the services of the life cycle until a garbage collection."""
        self._state_machine.destroy_when_not_in_use()
        super().destroy_node()

    def _try(self, *actions: Callable[[], None]) -> TransitionCallbackReturn:
        try:
            for action in actions:
                action()
        except Exception as error:
            # rclpy would swallow it; the caller in this process gets it, others read it in the log.
            self._refusal = error
            self.active = False
            self.get_logger().error(f"{error}")
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS

    def _withdraw(self) -> None:
        # What was published last is still wanted: what goes is not sent again.
        self.flush(WITHDRAW_SECONDS)
        for handles, destroy in (
            (self.timers, self.destroy_timer),
            (self.services, self.destroy_service),
            (self.subscriptions, self.destroy_subscription),
            (self.publishers, self.destroy_publisher),
        ):
            for handle in [handle for handle in handles if id(handle) not in self._permanent]:
                destroy(handle)

    def _handles(self) -> Iterable[Any]:
        return (*self.timers, *self.services, *self.subscriptions, *self.publishers)


def _refuse_politely(service: Any) -> None:
    """A transition that the present state does not have is answered with no; rclpy would let it end the process."""
    change_state = service.callback

    def answer(request: Any, response: Any) -> Any:
        try:
            return change_state(request, response)
        except RuntimeError:
            return fill(response, success=False)

    service.callback = answer


def bring_up(nodes: Iterable[GraphNode]) -> None:
    """Configure all managed nodes, then activate them, in the order given.

    Raises:
        Exception: what the first failing transition failed with.
    """
    managed = [node for node in nodes if isinstance(node, ManagedNode)]
    for node in managed:
        node.must(node.trigger_configure)
    for node in managed:
        node.must(node.trigger_activate)
