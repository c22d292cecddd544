"""A robot of your own: any arm's URDF on a satellite given in a few lines, and a task for it.

python examples/own_robot.py
"""

from pathlib import Path

import space_robot as sr

ARM = """
<robot name="two_links">
  <link name="root"/>
  <joint name="shoulder" type="revolute">
    <parent link="root"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="20" velocity="1"/>
  </joint>
  <link name="upper"><inertial><origin xyz="0 0 0.3"/><mass value="4"/>
    <inertia ixx="0.13" iyy="0.13" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="lower"/><origin xyz="0 0 0.6"/><axis xyz="0 1 0"/>
    <limit lower="-2.5" upper="2.5" effort="10" velocity="1"/>
  </joint>
  <link name="lower"><inertial><origin xyz="0 0 0.25"/><mass value="2.5"/>
    <inertia ixx="0.06" iyy="0.06" izz="0.005" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>
"""
ROBOT = """
name: two_links
urdf: two_links.urdf
base: {mass: 150.0, inertia: [25, 25, 25], mount: {xyz: [0, 0, 0.5]}}
base_mode: free_floating
home: {shoulder: 0.4, elbow: -0.8}
actuators: {joints: {}, base_torque: {kind: reaction_wheels, torque: 1.0, momentum: 10.0}}
"""


def main() -> None:
    """Write the two files, look at the robot, and move it."""
    Path("two_links.urdf").write_text(ARM.lstrip(), encoding="utf-8")
    Path("two_links.yaml").write_text(ROBOT, encoding="utf-8")
    robot = sr.load_robot("two_links.yaml")
    print(robot.name, robot.joint_names, "limits [N m]:", robot.effort_limit)
    task = {
        "robot": str(Path("two_links.yaml").resolve()),
        "controller.law": "computed_torque",
        "reference": {"kind": "quintic", "duration": 15.0, "attitude_deg": [0, 5, 0], "joints_by_deg": 20},
        "settling_bands": {},
        "expect": {},
        "duration": 20.0,
    }
    run = sr.run("compare/mini", task)
    print(run.reason, {axis.name: round(axis.final_error, 4) for axis in run.metrics.axes})


if __name__ == "__main__":
    main()
