"""The line between a run and its nodes: whole packets, and its end says that the other side is gone."""

from __future__ import annotations

import os
import queue
import subprocess
import sys
from time import monotonic

import pytest

from space_robot_bringup.modes.tether import MAX_PACKET, PARENT_DIED, ChildEnd, ParentEnd

STUCK = """
import sys, threading
from space_robot_bringup.modes import tether
end = tether.ChildEnd(int(sys.argv[1]), lambda reason: print(reason, flush=True))
end.grace = 0.1
end.tell(tick=3)
print("print is no message", flush=True)
while True:
    pass
"""


def pair() -> tuple[ParentEnd, ChildEnd, queue.Queue[str]]:
    parent, orders = ParentEnd(), queue.Queue[str]()
    child = ChildEnd(os.dup(parent.child.fileno()), orders.put)
    # A test is no process to be ended.
    child.grace = 1e9
    parent.child.close()
    return parent, child, orders


def test_news_and_orders_arrive_whole_and_in_order() -> None:
    """What the child sends arrives unchanged; an order comes once, and a later one only says that there is hurry."""
    parent, child, orders = pair()
    for tick in range(3):
        child.tell(tick=tick)
    child.tell(end="controller: a\nb")
    assert [parent.news() for _ in range(5)] == [{"tick": 0}, {"tick": 1}, {"tick": 2}, {"end": "controller: a\nb"}, {}]
    parent.order_end("completed", hurry=False)
    assert orders.get(timeout=20.0) == "completed"
    assert not child.hurry
    parent.order_end("completed", hurry=True)
    deadline = monotonic() + 20.0
    while not child.hurry:
        assert monotonic() < deadline, "waited 20 s for the second order"
    assert not child.bereaved
    parent.close()


def test_the_end_of_the_line_is_the_death_of_the_parent() -> None:
    """A child whose parent is gone is notified, and what it still sends does no harm."""
    parent, child, orders = pair()
    parent.close()
    assert orders.get(timeout=20.0) == PARENT_DIED
    assert child.hurry
    assert child.bereaved
    child.tell(tick=1)


@pytest.mark.parametrize("size", [MAX_PACKET - 100, MAX_PACKET, 10 * MAX_PACKET])
def test_a_reason_of_any_length_arrives(size: int) -> None:
    """A reason that is longer than a packet is cut, not lost."""
    parent, child, _ = pair()
    child.tell(end="x" * size)
    news = parent.news()
    assert news is not None
    assert set(news["end"]) == {"x"}
    parent.close()


def test_a_child_that_is_stuck_ends_with_its_parent() -> None:
    """Where the main thread never looks, the process ends nevertheless; its stdout is not read as news."""
    parent = ParentEnd()
    inherited = parent.child.fileno()
    command = [sys.executable, "-c", STUCK, str(inherited)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, pass_fds=(inherited,)) as child:
        parent.child.close()
        assert child.stdout is not None
        assert child.stdout.readline() == "print is no message\n"
        assert parent.news() == {"tick": 3}
        parent.close()
        assert child.stdout.readline() == f"{PARENT_DIED}\n"
        assert child.wait(20.0) == 1
