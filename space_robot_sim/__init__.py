"""What happens: the true robot with its actuators and sensors. ROS only in `nodes`."""

from typing import TYPE_CHECKING

from space_robot_msgs_py.faces import lazy_face

__all__ = [
    "AirbearingSpec",
    "AirbearingTestbed",
    "CapturedDebris",
    "CapturedSpec",
    "InitialState",
    "IntegratorSpec",
    "SensorSpec",
    "SimulatedRobot",
]

if TYPE_CHECKING:
    from space_robot_sim.grasp.airbearing import AirbearingTestbed
    from space_robot_sim.grasp.captured import CapturedDebris
    from space_robot_sim.grasp.spec import AirbearingSpec, CapturedSpec
    from space_robot_sim.initial import InitialState
    from space_robot_sim.plant import SimulatedRobot
    from space_robot_sim.spec import IntegratorSpec, SensorSpec
else:
    _MODULES = {
        "space_robot_sim.grasp.airbearing": ("AirbearingTestbed",),
        "space_robot_sim.grasp.captured": ("CapturedDebris",),
        "space_robot_sim.grasp.spec": ("AirbearingSpec", "CapturedSpec"),
        "space_robot_sim.initial": ("InitialState",),
        "space_robot_sim.plant": ("SimulatedRobot",),
        "space_robot_sim.spec": ("IntegratorSpec", "SensorSpec"),
    }
    __getattr__, __dir__ = lazy_face(__name__, _MODULES)
