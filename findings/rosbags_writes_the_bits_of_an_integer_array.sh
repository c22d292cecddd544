#!/usr/bin/env bash
# rosbags writes the bits of an integer array into a field of float64: 1, 2, 3 are read back as 5e-324, 1e-323, 1.5e-323.
#
# rosbags 0.11.9, NumPy 2.3.5, Python 3.11, Linux.
#
# serialize_cdr takes an array field's bytes as they are and compares neither the dtype nor the byte order with the message
# definition. numpy.array([1, 2, 3]) has the right size, so joint positions written that way are a valid bag of zeros to
# the eye; a big-endian array (from a FITS file, the network) is garbage as well. Only another item size, float32 for
# instance, raises an error. Single numbers are converted as one expects. Cure: numpy.asarray(values, "<f8").
#
# Seen: "position [1, 2, 3] -> [4.9e-324, 9.9e-324, 1.5e-323]; velocity (big-endian 1, 2, 3) -> [3.0e-319, 3.2e-322, 1.0e-320]"
#       "point x=1 -> 1.0; float32 array: ValueError"
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/python -m pip install -q --disable-pip-version-check rosbags==0.11.9 numpy==2.3.5

cat > bits.py <<'PY'
import sys
import numpy as np
from rosbags.typesys import Stores, get_typestore

store = get_typestore(Stores.ROS2_JAZZY)
types = store.types

def back(message):
    name = message.__msgtype__
    return store.deserialize_cdr(store.serialize_cdr(message, name), name)

def joints(position, velocity):
    stamp = types["builtin_interfaces/msg/Time"](sec=1, nanosec=0)
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="base")
    return types["sensor_msgs/msg/JointState"](header=header, name=["a", "b", "c"], position=position, velocity=velocity,
                                               effort=np.zeros(0))

right = np.array([1.0, 2.0, 3.0])
whole = back(joints(right, right))
read = back(joints(np.array([1, 2, 3]), right.astype(">f8")))
point = back(types["geometry_msgs/msg/Point"](x=1, y=2, z=3))
try:
    back(joints(right.astype(np.float32), right))
    single = "accepted"
except ValueError:
    single = "ValueError"
text = ["[" + ", ".join(f"{number:.1e}" for number in array) + "]" for array in (read.position, read.velocity)]
print(f"position [1, 2, 3] -> {text[0]}; velocity (big-endian 1, 2, 3) -> {text[1]}")
print(f"point x=1 -> {point.x}; float32 array: {single}")
good = np.array_equal(whole.position, right) and point.x == 1.0 and single == "ValueError"
bad = all(np.all(array > 0.0) and np.all(array < 1e-300) for array in (read.position, read.velocity))
sys.exit(0 if good and bad else 1)
PY
venv/bin/python bits.py
