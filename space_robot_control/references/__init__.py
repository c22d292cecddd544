"""References: desired motion as a function of time, exact to the second derivative; no ROS."""

from space_robot_control.references.make import make_reference
from space_robot_control.references.recorded import Recorded
from space_robot_control.references.spec import ReferenceSpec

__all__ = ["Recorded", "ReferenceSpec", "make_reference"]
