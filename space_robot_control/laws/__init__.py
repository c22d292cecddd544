"""Control laws: equations with a nominal model and gains; no ROS."""

from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.registry import law_class, law_names, make_law

__all__ = ["Blocks", "Law", "Review", "law_class", "law_names", "make_law"]
