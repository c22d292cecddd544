"""Faults of links and nodes: messages that do not arrive, or late, or twice; nodes that say nothing or begin anew."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, PositiveInt

from space_robot_msgs_py.errors import SpecError
from space_robot_sim.faults.base import Fault, FaultSite

Probability = Annotated[float, Field(gt=0.0, le=1.0)]
LinkName = Literal["command", "state", "reference"]


class LinkFault(Fault):
    """What all of them have: a link, and what becomes of a message on it."""

    group: ClassVar[str] = "links"
    topic: LinkName = Field(
        description="`command` to the plant, `state` or `reference` to the controller, all messages of a stamp together"
    )

    @property
    def place(self) -> str:
        """The link."""
        return self.topic

    def arrivals(self, rng: np.random.Generator) -> tuple[int, ...]:
        """After how many periods a message sent now arrives, each time it does."""
        raise NotImplementedError


class LinkDrop(LinkFault):
    """Messages are lost."""

    kind: Literal["link_drop"] = "link_drop"
    probability: Probability = Field(default=1.0, description="of each message [-]")

    def arrivals(self, rng: np.random.Generator) -> tuple[int, ...]:
        """Never, or at once."""
        return () if rng.random() < self.probability else (0,)


class LinkDelay(LinkFault):
    """Messages arrive later."""

    kind: Literal["link_delay"] = "link_delay"
    periods: PositiveInt = Field(description="control periods")

    def arrivals(self, rng: np.random.Generator) -> tuple[int, ...]:
        """Later."""
        return (self.periods,)


class LinkDuplicate(LinkFault):
    """Messages arrive twice, the second time a period later: the older of two is not taken, so it must be harmless."""

    kind: Literal["link_duplicate"] = "link_duplicate"
    probability: Probability = Field(default=1.0, description="of each message [-]")

    def arrivals(self, rng: np.random.Generator) -> tuple[int, ...]:
        """At once, and perhaps again."""
        return (0, 1) if rng.random() < self.probability else (0,)


class LinkReorder(LinkFault):
    """Messages are overtaken by the next one, and are then too old to be taken."""

    kind: Literal["link_reorder"] = "link_reorder"
    probability: Probability = Field(description="of each message [-]")

    def arrivals(self, rng: np.random.Generator) -> tuple[int, ...]:
        """At once, or with the next one."""
        return (1,) if rng.random() < self.probability else (0,)


class LinkCorrupt(LinkFault):
    """The bytes of messages are damaged on the way; the receiver refuses them."""

    kind: Literal["link_corrupt"] = "link_corrupt"
    probability: Probability = Field(default=1.0, description="of each message [-]")

    def arrivals(self, rng: np.random.Generator) -> tuple[int, ...]:
        """As nothing that can be used, or at once."""
        return () if rng.random() < self.probability else (0,)


class NodeFault(LinkFault):
    """A node that says nothing: whatever it sends is lost."""

    group: ClassVar[str] = "nodes"

    @property
    def place(self) -> str:
        """The node is in the kind."""
        return ""

    def arrivals(self, rng: np.random.Generator) -> tuple[int, ...]:
        """Never."""
        return ()


class ControllerSilent(NodeFault):
    """The controller answers nothing, and is reset when it is back; the log has what it would have said."""

    kind: Literal["controller_silent"] = "controller_silent"
    topic: Literal["command"] = Field(default="command", description="only this one")


class GuidanceSilent(NodeFault):
    """Guidance says nothing: the controller goes on with the last reference it heard."""

    kind: Literal["guidance_silent"] = "guidance_silent"
    topic: Literal["reference"] = Field(default="reference", description="only this one")


class ControllerRestarted(Fault):
    """The controller forgets its past at the onset and goes on at once, as the first time."""

    group: ClassVar[str] = "nodes"
    kind: Literal["controller_restarted"] = "controller_restarted"

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse to take time."""
        if self.for_ is not None:
            accepted = "nothing; to be away for some time: controller_silent"
            raise SpecError("takes no time", key=f"{key}.for", value=self.for_, accepted=accepted)
