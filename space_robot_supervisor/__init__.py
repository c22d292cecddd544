"""What watches: values, monitors, events and modes over a controller, from a table; a function of ticks alone."""

from typing import TYPE_CHECKING

from space_robot_msgs_py.faces import lazy_face

__all__ = ["Snapshot", "SupervisionTable", "Supervisor"]

if TYPE_CHECKING:
    from space_robot_supervisor.supervisor import Supervisor
    from space_robot_supervisor.table import SupervisionTable
    from space_robot_supervisor.values import Snapshot
else:
    _MODULES = {
        "space_robot_supervisor.supervisor": ("Supervisor",),
        "space_robot_supervisor.table": ("SupervisionTable",),
        "space_robot_supervisor.values": ("Snapshot",),
    }
    __getattr__, __dir__ = lazy_face(__name__, _MODULES)
