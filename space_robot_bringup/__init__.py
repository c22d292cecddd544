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
    from space_robot_bringup.compose.composition import Composition
    from space_robot_bringup.experiment.experiment import Experiment, load_experiment
    from space_robot_bringup.judge.check import Check
    from space_robot_bringup.judge.metrics import Axis, RunMetrics
    from space_robot_bringup.logs.assessed import JudgedLog, read_judged
    from space_robot_bringup.modes.hooks import Hooks
    from space_robot_bringup.modes.run import RunResult, run_experiment
    from space_robot_bringup.public.arrays import RunArrays
    from space_robot_bringup.public.result import Run
else:
    _MODULES = {
        "space_robot_bringup.compose.composition": ("Composition",),
        "space_robot_bringup.experiment.experiment": ("Experiment", "load_experiment"),
        "space_robot_bringup.logs.assessed": ("JudgedLog", "read_judged"),
        "space_robot_bringup.judge.metrics": ("Axis", "RunMetrics"),
        "space_robot_bringup.public.arrays": ("RunArrays",),
        "space_robot_bringup.public.result": ("Run",),
        "space_robot_bringup.modes.hooks": ("Hooks",),
        "space_robot_bringup.modes.run": ("RunResult", "run_experiment"),
        "space_robot_bringup.judge.check": ("Check",),
    }
    __getattr__, __dir__ = lazy_face(__name__, _MODULES)
