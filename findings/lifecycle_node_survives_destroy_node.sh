#!/usr/bin/env bash
# A LifecycleNode of rclpy stays in the graph after destroy_node(), with its services and its DDS participant.
#
# rclpy 7.1.6, rmw_fastrtps_cpp 8.4.3, Jazzy wheels, Python 3.11, Linux.
#
# Node.destroy_node() destroys publishers, services and the node; the state machine of a LifecycleNode is not among them
# and keeps node, services (change_state, get_state, ...) and context alive until the garbage collector finds the cycle
# they are in. Until then other nodes see them, and service_is_ready() of the next client of that name may stay False,
# because it compares the numbers of readers and writers it has heard of. The threads of the participant stay as well.
# A plain Node leaves nothing. Cure: node._state_machine.destroy_when_not_in_use() before destroy_node().
#
# Seen: "after 5 plain nodes: 0 in the graph; after 5 lifecycle nodes: 5 in the graph, cured: 0"
#       "threads left: 4, 40, cured: 0" (the first context of a process starts 4 that stay)
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/python -m pip install -q --disable-pip-version-check ros-jazzy-rclpy==7.1.6 ros-jazzy-rmw-fastrtps-cpp==8.4.3

cat > ghosts.py <<'PY'
import gc, os, sys, time
import rclpy
from rclpy.context import Context
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node

gc.disable()
DOMAIN, COUNT = int(os.environ["ROS_DOMAIN_ID"]), 5

def ghosts(kind, name, cured=False):
    """Make and destroy nodes, each in its own context; how many are seen afterwards, and their threads."""
    before = len(os.listdir("/proc/self/task"))
    for _ in range(COUNT):
        context = Context()
        rclpy.init(context=context, domain_id=DOMAIN)
        node = kind(name, context=context)
        if cured:
            node._state_machine.destroy_when_not_in_use()
        node.destroy_node()
        context.try_shutdown()
        del node, context
    threads = len(os.listdir("/proc/self/task")) - before
    context = Context()
    rclpy.init(context=context, domain_id=DOMAIN)
    watcher = Node("watcher", context=context)
    expected, end = (COUNT if kind is LifecycleNode and not cured else 0), time.monotonic() + 20.0
    time.sleep(2.0)
    while (seen := watcher.get_node_names().count(name)) < expected and time.monotonic() < end:
        time.sleep(0.1)
    watcher.destroy_node()
    context.try_shutdown()
    return seen, threads

plain = ghosts(Node, "plain")
cured = ghosts(LifecycleNode, "cured", cured=True)
managed = ghosts(LifecycleNode, "managed")
print(f"after {COUNT} plain nodes: {plain[0]} in the graph; after {COUNT} lifecycle nodes: {managed[0]} in the graph, "
      f"cured: {cured[0]}")
print(f"threads left: {plain[1]}, {managed[1]}, cured: {cured[1]}")
sys.exit(0 if plain[0] == cured[0] == 0 and managed[0] == COUNT and managed[1] > cured[1] else 1)
PY

export ROS_DOMAIN_ID="${ROS_DOMAIN_ID:-72}" ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST
venv/bin/python ghosts.py
