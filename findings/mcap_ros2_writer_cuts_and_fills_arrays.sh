#!/usr/bin/env bash
# The Python writer of mcap-ros2-support cuts and fills arrays to their length, and forgets a field with a wrong name.
#
# mcap-ros2-support 0.6.0, mcap 1.6.0, Python 3.11, Linux.
#
# A sequence that is longer than its bound and a fixed array that is longer than its size lose their tail; a shorter fixed
# array is filled with zeros (so two of three coordinates make a valid point); a key that is not in the definition is
# dropped, and the field that it was meant for gets its default. None of this raises or warns, though the package has a
# ROS2EncodeError; but a string is written beyond its bound, which other readers need not accept.
# Cure: compare keys and lengths with the definition before writing.
#
# Seen: "float64[3]: [1.0, 2.0] -> [1.0, 2.0, 0.0], [1.0, 2.0, 3.0, 4.0] -> [1.0, 2.0, 3.0]; float64[<=3]: -> [1.0, 2.0, 3.0]"
#       "string<=3: abcdef -> abcdef; {'positon': 2.0} -> position 0.0"
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/python -m pip install -q --disable-pip-version-check mcap-ros2-support==0.6.0 mcap==1.6.0

cat > lengths.py <<'PY'
import io, sys
from mcap_ros2.reader import read_ros2_messages
from mcap_ros2.writer import Writer

def back(definition, message):
    """Write one message to a file in memory, read it again."""
    file = io.BytesIO()
    writer = Writer(file)
    writer.write_message("/topic", writer.register_msgdef("demo_msgs/msg/Demo", definition), message)
    writer.finish()
    file.seek(0)
    return next(iter(read_ros2_messages(file))).ros_msg

short = list(back("float64[3] x", {"x": [1.0, 2.0]}).x)
long = list(back("float64[3] x", {"x": [1.0, 2.0, 3.0, 4.0]}).x)
bound = list(back("float64[<=3] x", {"x": [1.0, 2.0, 3.0, 4.0]}).x)
text = back("string<=3 x", {"x": "abcdef"}).x
wrong = back("float64 position", {"positon": 2.0}).position
print(f"float64[3]: [1.0, 2.0] -> {short}, [1.0, 2.0, 3.0, 4.0] -> {long}; float64[<=3]: -> {bound}")
print(f"string<=3: abcdef -> {text}; {{'positon': 2.0}} -> position {wrong}")
sys.exit(0 if short == [1.0, 2.0, 0.0] and long == bound == [1.0, 2.0, 3.0] and text == "abcdef" and wrong == 0.0 else 1)
PY
venv/bin/python lengths.py
