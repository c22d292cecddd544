"""Flight software of a space robot, emulated: the public names of the project, all of them stable.

    import space_robot as sr

    run = sr.run("liu2023/fig08", {"controller.gains.lambda": 0.7})

Nothing is loaded before it is used. Whatever is not here may move or change without notice.
"""

from typing import TYPE_CHECKING

from space_robot_msgs_py.faces import lazy_face

__all__ = [
    "assert_conserved",
    "assert_events",
    "assert_tracking",
    "benchmark",
    "Blocks",
    "campaign",
    "closed_loop",
    "Command",
    "compare",
    "ControlOutput",
    "error_blocks",
    "Experiment",
    "export",
    "GainRange",
    "judge",
    "Law",
    "load_experiment",
    "load_robot",
    "LogHeader",
    "LogReader",
    "LogWriter",
    "make_plant",
    "NominalModel",
    "open_graph",
    "OpenGraph",
    "PlantSample",
    "Reference",
    "replay",
    "reproduce",
    "Robot",
    "RobotState",
    "Run",
    "run",
    "SpaceRobotError",
    "SpaceRobotWarning",
    "SteppedPlant",
    "sweep",
    "Telemetry",
    "Tick",
    "tracking_errors",
    "tune",
    "Vector",
    "__version__",
]

if TYPE_CHECKING:
    from space_robot_bringup.experiment.experiment import Experiment, load_experiment
    from space_robot_bringup.public.assertions import assert_conserved, assert_events, assert_tracking
    from space_robot_bringup.public.export import export
    from space_robot_bringup.public.judge import judge
    from space_robot_bringup.public.open_graph import OpenGraph, open_graph
    from space_robot_bringup.public.replay import replay
    from space_robot_bringup.public.result import Run
    from space_robot_bringup.public.run import run
    from space_robot_bringup.public.stepping import SteppedPlant, closed_loop, make_plant
    from space_robot_control.laws.base import Blocks, Law
    from space_robot_control.laws.gain_range import GainRange
    from space_robot_control.nominal_model import NominalModel
    from space_robot_control.tracking import error_blocks, tracking_errors
    from space_robot_description.load import load_robot
    from space_robot_description.robot import Robot
    from space_robot_msgs_py.errors import SpaceRobotError, SpaceRobotWarning
    from space_robot_msgs_py.interfaces import (
        Command,
        ControlOutput,
        PlantSample,
        Reference,
        RobotState,
        Telemetry,
        Tick,
        Vector,
    )
    from space_robot_msgs_py.log.header import LogHeader
    from space_robot_msgs_py.log.reader import LogReader
    from space_robot_msgs_py.log.writer import LogWriter
    from space_robot_msgs_py.version import __version__
    from space_robot_studies.benchmark.public import benchmark
    from space_robot_studies.campaign.public import campaign
    from space_robot_studies.campaign.sweep import sweep
    from space_robot_studies.compare.public import compare
    from space_robot_studies.reproduce.public import reproduce
    from space_robot_studies.tune.public import tune
else:
    _MODULES = {
        "space_robot_studies.benchmark.public": ("benchmark",),
        "space_robot_studies.campaign.public": ("campaign",),
        "space_robot_studies.campaign.sweep": ("sweep",),
        "space_robot_studies.compare.public": ("compare",),
        "space_robot_bringup.experiment.experiment": ("Experiment", "load_experiment"),
        "space_robot_bringup.public.assertions": ("assert_conserved", "assert_events", "assert_tracking"),
        "space_robot_bringup.public.export": ("export",),
        "space_robot_bringup.public.judge": ("judge",),
        "space_robot_bringup.public.open_graph": ("OpenGraph", "open_graph"),
        "space_robot_bringup.public.replay": ("replay",),
        "space_robot_bringup.public.result": ("Run",),
        "space_robot_bringup.public.run": ("run",),
        "space_robot_bringup.public.stepping": ("SteppedPlant", "closed_loop", "make_plant"),
        "space_robot_studies.reproduce.public": ("reproduce",),
        "space_robot_control.laws.base": ("Blocks", "Law"),
        "space_robot_control.laws.gain_range": ("GainRange",),
        "space_robot_studies.tune.public": ("tune",),
        "space_robot_control.nominal_model": ("NominalModel",),
        "space_robot_control.tracking": ("error_blocks", "tracking_errors"),
        "space_robot_description.load": ("load_robot",),
        "space_robot_description.robot": ("Robot",),
        "space_robot_msgs_py.errors": ("SpaceRobotError", "SpaceRobotWarning"),
        "space_robot_msgs_py.interfaces": (
            "Command",
            "ControlOutput",
            "PlantSample",
            "Reference",
            "RobotState",
            "Telemetry",
            "Tick",
            "Vector",
        ),
        "space_robot_msgs_py.log.header": ("LogHeader",),
        "space_robot_msgs_py.log.reader": ("LogReader",),
        "space_robot_msgs_py.log.writer": ("LogWriter",),
        "space_robot_msgs_py.version": ("__version__",),
    }
    __getattr__, __dir__ = lazy_face(__name__, _MODULES)
