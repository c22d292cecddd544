#!/usr/bin/env bash
# Pinocchio builds a massless link from a URDF whose mass has a space before the number; the tensor goes where ixy is missing.
#
# pin 4.1.0, mujoco 4.0.0, NumPy 2.4.6, Python 3.11, Linux.
#
# Its URDF parser prints a line on stderr when it cannot read an <inertial>, and goes on with what it has: with mass " 2 "
# (a number in XML may have white space round it) the whole element is gone; without ixy, ixz and iyz the mass stays and the
# tensor is zero. No exception, and the model computes: dynamics are of another robot. MuJoCo reads 2 kg from the first file
# and refuses the second.
# Cure: compare masses and inertias of the model with the file after loading.
#
# Seen: "mass ' 2 ': Pinocchio 0.0 kg, MuJoCo 2.0 kg; only ixx, iyy, izz: Pinocchio 2.0 kg, trace 0.0, MuJoCo ValueError"
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/python -m pip install -q --disable-pip-version-check pin==4.1.0 mujoco==4.0.0 numpy==2.4.6

cat > inertial.py <<'PY'
import sys
import mujoco
import numpy as np
import pinocchio

def robot(mass, products):
    return f'''<robot name="arm"><link name="base"/><link name="arm"><inertial><origin xyz="1 0 0"/><mass value="{mass}"/>
<inertia ixx="1" iyy="1" izz="1" {products}/></inertial></link><joint name="joint" type="revolute"><parent link="base"/>
<child link="arm"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'''

zeros = 'ixy="0" ixz="0" iyz="0"'
good = pinocchio.buildModelFromXML(robot("2", zeros)).inertias[1]
space = pinocchio.buildModelFromXML(robot(" 2 ", zeros)).inertias[1]
short = pinocchio.buildModelFromXML(robot("2", "")).inertias[1]
other = mujoco.MjModel.from_xml_string(robot(" 2 ", zeros)).body_mass[1]
try:
    mujoco.MjModel.from_xml_string(robot("2", ""))
    refused = "accepted"
except ValueError:
    refused = "ValueError"
print(f"mass ' 2 ': Pinocchio {space.mass} kg, MuJoCo {other} kg; only ixx, iyy, izz: Pinocchio {short.mass} kg, "
      f"trace {np.trace(short.inertia)}, MuJoCo {refused}")
sys.exit(0 if good.mass == other == 2.0 and np.trace(good.inertia) == 3.0 and space.mass == 0.0 and short.mass == 2.0
         and np.trace(short.inertia) == 0.0 and refused == "ValueError" else 1)
PY
venv/bin/python inertial.py
