#!/usr/bin/env bash
# rclpy sends an int in a float64 field as a denormal, a negative one as NaN, and says nothing.
#
# rclpy 7.1.6, common_interfaces 5.3.6, Jazzy wheels, Python 3.11, Linux.
#
# A message's fields are checked only with ROS_PYTHON_CHECK_FIELDS=1 (or check_fields=True). Without it the setter keeps any
# object, and the C code copies the eight bytes where a Python float has its number. In an int these bytes are the count of
# its digits: 1 to 2**30-1 all become 5e-324, which prints as 0.0000 and moves nothing; 0 is right by chance; a negative int
# is NaN. numpy.float32(1.5) is 5.3e-315. In the process that sends it, the message still prints as x=1. An array field is
# converted as one expects, and so is an int32 field that is too large refused by nobody: 2**40 is sent as 0.
# Cure: float(value) at every assignment, and ROS_PYTHON_CHECK_FIELDS=1 in tests, which makes it an AssertionError.
#
# Seen: "before: Point(x=1, y=-1, z=0); after: 5e-324, nan, 0.0; float32 1.5: 5.28e-315; array [1, -1]: [1.0, -1.0]"
#       "int32 2**40: 0; with check_fields=True: AssertionError"
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/python -m pip install -q --disable-pip-version-check \
  ros-jazzy-rclpy==7.1.6 ros-jazzy-rmw-fastrtps-cpp==8.4.3 \
  ros-jazzy-common-interfaces==5.3.6

cat > ints.py <<'PY'
import math, sys
import numpy as np
from geometry_msgs.msg import Point
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Float64, Float64MultiArray, Int32

def arrives(message):
    return deserialize_message(serialize_message(message), type(message))

sent = Point(x=1, y=-1, z=0)
point = arrives(sent)
single = arrives(Float64(data=np.float32(1.5))).data
array = list(arrives(Float64MultiArray(data=[1, -1])).data)
whole = arrives(Int32(data=2**40)).data
try:
    Point(x=1, y=-1, z=0, check_fields=True)
    checked = "accepted"
except AssertionError:
    checked = "AssertionError"
print(f"before: Point(x={sent.x}, y={sent.y}, z={sent.z}); after: {point.x}, {point.y}, {point.z}; "
      f"float32 1.5: {single:.3g}; array [1, -1]: {array}")
print(f"int32 2**40: {whole}; with check_fields=True: {checked}")
sys.exit(0 if 0.0 < point.x < 1e-300 and math.isnan(point.y) and point.z == 0.0 and 0.0 < single < 1e-300
         and array == [1.0, -1.0] and whole == 0 and checked == "AssertionError" else 1)
PY
env -u ROS_PYTHON_CHECK_FIELDS venv/bin/python ints.py
