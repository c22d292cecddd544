"""What the robot IS: URDF and YAML in, Pinocchio model out."""

from typing import TYPE_CHECKING

from space_robot_msgs_py.faces import lazy_face

__all__ = [
    "attach_payload",
    "disperse",
    "Dispersion",
    "DYNAMIC",
    "load_robot",
    "Payload",
    "Robot",
    "robot_report",
    "RobotReport",
    "shipped",
    "Strict",
]

if TYPE_CHECKING:
    from space_robot_description.dispersion import Dispersion, disperse
    from space_robot_description.fields import DYNAMIC
    from space_robot_description.load import load_robot
    from space_robot_description.payload import Payload, attach_payload
    from space_robot_description.report import RobotReport, robot_report
    from space_robot_description.robot import Robot
    from space_robot_description.share import shipped
    from space_robot_description.spec import Strict
else:
    _MODULES = {
        "space_robot_description.dispersion": ("Dispersion", "disperse"),
        "space_robot_description.fields": ("DYNAMIC",),
        "space_robot_description.load": ("load_robot",),
        "space_robot_description.payload": ("Payload", "attach_payload"),
        "space_robot_description.report": ("RobotReport", "robot_report"),
        "space_robot_description.robot": ("Robot",),
        "space_robot_description.share": ("shipped",),
        "space_robot_description.spec": ("Strict",),
    }
    __getattr__, __dir__ = lazy_face(__name__, _MODULES)
