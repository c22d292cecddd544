"""References: desired motion as a function of time, exact to the second derivative; no ROS."""

from typing import TYPE_CHECKING

from space_robot_msgs_py.faces import lazy_face

__all__ = ["make_reference", "Recorded", "ReferenceSpec"]

if TYPE_CHECKING:
    from space_robot_control.references.make import make_reference
    from space_robot_control.references.recorded import Recorded
    from space_robot_control.references.spec import ReferenceSpec
else:
    _MODULES = {
        "space_robot_control.references.make": ("make_reference",),
        "space_robot_control.references.recorded": ("Recorded",),
        "space_robot_control.references.spec": ("ReferenceSpec",),
    }
    __getattr__, __dir__ = lazy_face(__name__, _MODULES)
