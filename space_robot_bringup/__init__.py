"""What is COMPOSED: experiment file in, objects and runs out."""

from typing import TYPE_CHECKING

from space_robot_msgs_py.faces import lazy_face

__all__ = [
    "Axis",
    "Check",
    "Composition",
    "Experiment",
    "Hooks",
    "JudgedLog",
    "load_experiment",
    "read_judged",
    "Run",
    "run_experiment",
    "RunArrays",
    "RunMetrics",
    "RunResult",
]

if TYPE_CHECKING:
    from space_robot_bringup.compose import Composition
    from space_robot_bringup.experiment import Experiment, load_experiment
    from space_robot_bringup.judged import JudgedLog, read_judged
    from space_robot_bringup.metrics import Axis, RunMetrics
    from space_robot_bringup.public.arrays import RunArrays
    from space_robot_bringup.public.result import Run
    from space_robot_bringup.run import Hooks, RunResult, run_experiment
    from space_robot_bringup.verdict import Check
else:
    _MODULES = {
        "space_robot_bringup.compose": ("Composition",),
        "space_robot_bringup.experiment": ("Experiment", "load_experiment"),
        "space_robot_bringup.judged": ("JudgedLog", "read_judged"),
        "space_robot_bringup.metrics": ("Axis", "RunMetrics"),
        "space_robot_bringup.public.arrays": ("RunArrays",),
        "space_robot_bringup.public.result": ("Run",),
        "space_robot_bringup.run": ("Hooks", "RunResult", "run_experiment"),
        "space_robot_bringup.verdict": ("Check",),
    }
    __getattr__, __dir__ = lazy_face(__name__, _MODULES)
