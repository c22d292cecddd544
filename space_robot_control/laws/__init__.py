"""Control laws: equations with a nominal model and gains; no ROS."""

from typing import TYPE_CHECKING

from space_robot_msgs_py.faces import lazy_face

__all__ = ["Blocks", "Law", "Review", "law_class", "law_names", "make_law"]

if TYPE_CHECKING:
    from space_robot_control.laws.base import Blocks, Law, Review
    from space_robot_control.laws.registry import law_class, law_names, make_law
else:
    # Lazy: a law brings its compiler, 90 MB, and what reads logs only looks at ``policy``.
    _MODULES = {
        "space_robot_control.laws.base": ("Blocks", "Law", "Review"),
        "space_robot_control.laws.registry": ("law_class", "law_names", "make_law"),
    }
    __getattr__, __dir__ = lazy_face(__name__, _MODULES)
