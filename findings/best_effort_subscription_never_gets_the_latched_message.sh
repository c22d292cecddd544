#!/usr/bin/env bash
# A BEST_EFFORT, TRANSIENT_LOCAL subscription is matched with a latched topic and never gets what is latched.
#
# rclpy 7.1.6, rmw_fastrtps_cpp 8.4.3 (Fast DDS 2.14.5), Jazzy wheels, Python 3.11, Linux.
#
# The publisher is RELIABLE and TRANSIENT_LOCAL (a robot description, a map), the subscription asks for TRANSIENT_LOCAL, too,
# and is content with BEST_EFFORT. Both policies are compatible, both ends count the match, qos_check_compatible finds no
# error, and no event of incompatible QoS comes. But history is sent as a repair to a reader that asks for it, and a
# best-effort reader never asks. It gets the next message that is published, which for a latched topic may be never.
# Cure: a subscription of a latched topic must ask for RELIABLE, too.
#
# Seen: "matched: 2 subscriptions; incompatible: 0 events; latched message: reliable 1, best effort 0; next one: 1 and 1"
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/python -m pip install -q --disable-pip-version-check \
  ros-jazzy-rclpy==7.1.6 ros-jazzy-rmw-fastrtps-cpp==8.4.3 \
  ros-jazzy-common-interfaces==5.3.6

cat > late.py <<'PY'
import sys, time
import rclpy
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSCompatibility, QoSProfile, ReliabilityPolicy, qos_check_compatible
from std_msgs.msg import String

def latched(reliability):
    return QoSProfile(depth=1, reliability=reliability, durability=DurabilityPolicy.TRANSIENT_LOCAL)

rclpy.init()
robot, late = rclpy.create_node("robot"), rclpy.create_node("late")
executor = SingleThreadedExecutor()
executor.add_node(robot)
executor.add_node(late)
RELIABLE, BEST_EFFORT = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
publisher = robot.create_publisher(String, "description", latched(RELIABLE))
publisher.publish(String(data="latched"))
heard, events = {RELIABLE: [], BEST_EFFORT: []}, []
for policy in heard:
    late.create_subscription(String, "description", lambda message, policy=policy: heard[policy].append(message.data),
                             latched(policy), event_callbacks=SubscriptionEventCallbacks(incompatible_qos=events.append))

def spin(done, seconds=0.0):
    """Until it is done, and then some seconds more."""
    end = time.monotonic() + 60.0
    while not done() and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.1)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.1)

spin(lambda: publisher.get_subscription_count() == 2 and heard[RELIABLE], 5.0)
count = publisher.get_subscription_count()
old = [heard[policy].count("latched") for policy in (RELIABLE, BEST_EFFORT)]
for _ in range(5):
    publisher.publish(String(data="next"))
    spin(lambda: True, 1.0)
    if all("next" in one for one in heard.values()):
        break
new = [int("next" in heard[policy]) for policy in (RELIABLE, BEST_EFFORT)]
error = qos_check_compatible(latched(RELIABLE), latched(BEST_EFFORT))[0] == QoSCompatibility.ERROR
print(f"matched: {count} subscriptions; incompatible: {len(events)} events; latched message: reliable {old[0]}, "
      f"best effort {old[1]}; next one: {new[0]} and {new[1]}")
sys.exit(0 if count == 2 and not events and not error and old == [1, 0] and new == [1, 1] else 1)
PY

export ROS_DOMAIN_ID="${ROS_DOMAIN_ID:-75}" ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST
venv/bin/python late.py
