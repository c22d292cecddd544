"""What decides: laws and references in pure NumPy and Pinocchio; ROS only in ``nodes``."""

from typing import TYPE_CHECKING

from space_robot_msgs_py.faces import lazy_face

__all__ = [
    "Blocks",
    "error_blocks",
    "Law",
    "law_class",
    "law_names",
    "make_law",
    "make_reference",
    "NominalModel",
    "ReferenceSpec",
    "Review",
    "tracking_errors",
    "TrackingErrors",
]

if TYPE_CHECKING:
    from space_robot_control.laws.base import Blocks, Law, Review
    from space_robot_control.laws.registry import law_class, law_names, make_law
    from space_robot_control.nominal_model import NominalModel
    from space_robot_control.references.make import make_reference
    from space_robot_control.references.spec import ReferenceSpec
    from space_robot_control.tracking import TrackingErrors, error_blocks, tracking_errors
else:
    _MODULES = {
        "space_robot_control.laws.base": ("Blocks", "Law", "Review"),
        "space_robot_control.nominal_model": ("NominalModel",),
        "space_robot_control.laws.registry": ("law_class", "law_names", "make_law"),
        "space_robot_control.tracking": ("TrackingErrors", "error_blocks", "tracking_errors"),
        "space_robot_control.references.make": ("make_reference",),
        "space_robot_control.references.spec": ("ReferenceSpec",),
    }
    __getattr__, __dir__ = lazy_face(__name__, _MODULES)
