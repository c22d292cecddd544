"""What flows: value types, protocols, errors, the topic table, message layouts and the log file."""

from typing import TYPE_CHECKING

from space_robot_msgs_py.faces import lazy_face

__all__ = [
    "Command",
    "CommandError",
    "ControlError",
    "Controller",
    "ControllerEvent",
    "ControlOutput",
    "InertiaError",
    "InputFileError",
    "IntegrationError",
    "LayoutError",
    "LogArrays",
    "LogError",
    "LogHeader",
    "LogReader",
    "LogSink",
    "LogWriter",
    "MemorySink",
    "NANOSECONDS",
    "NonFiniteError",
    "Plant",
    "PlantSample",
    "Reference",
    "ReferenceSource",
    "RobotState",
    "SilenceError",
    "Sink",
    "SpaceRobotError",
    "SpaceRobotWarning",
    "SpecError",
    "TABLE",
    "Telemetry",
    "Tick",
    "Topic",
    "Vector",
    "__version__",
]

if TYPE_CHECKING:
    from space_robot_msgs_py.errors import (
        CommandError,
        ControlError,
        InertiaError,
        InputFileError,
        IntegrationError,
        LayoutError,
        LogError,
        NonFiniteError,
        SilenceError,
        SpaceRobotError,
        SpaceRobotWarning,
        SpecError,
    )
    from space_robot_msgs_py.events import ControllerEvent
    from space_robot_msgs_py.interfaces import (
        NANOSECONDS,
        Command,
        Controller,
        ControlOutput,
        Plant,
        PlantSample,
        Reference,
        ReferenceSource,
        RobotState,
        Sink,
        Telemetry,
        Tick,
        Vector,
    )
    from space_robot_msgs_py.log_arrays import LogArrays
    from space_robot_msgs_py.log_header import LogHeader
    from space_robot_msgs_py.log_reader import LogReader
    from space_robot_msgs_py.log_writer import LogSink, LogWriter, MemorySink
    from space_robot_msgs_py.topics import TABLE, Topic
    from space_robot_msgs_py.version import __version__
else:
    _MODULES = {
        "space_robot_msgs_py.errors": (
            "CommandError",
            "ControlError",
            "InertiaError",
            "InputFileError",
            "IntegrationError",
            "LayoutError",
            "LogError",
            "NonFiniteError",
            "SilenceError",
            "SpaceRobotError",
            "SpaceRobotWarning",
            "SpecError",
        ),
        "space_robot_msgs_py.events": ("ControllerEvent",),
        "space_robot_msgs_py.interfaces": (
            "NANOSECONDS",
            "Command",
            "Controller",
            "ControlOutput",
            "Plant",
            "PlantSample",
            "Reference",
            "ReferenceSource",
            "RobotState",
            "Sink",
            "Telemetry",
            "Tick",
            "Vector",
        ),
        "space_robot_msgs_py.log_arrays": ("LogArrays",),
        "space_robot_msgs_py.log_header": ("LogHeader",),
        "space_robot_msgs_py.log_reader": ("LogReader",),
        "space_robot_msgs_py.log_writer": ("LogSink", "LogWriter", "MemorySink"),
        "space_robot_msgs_py.topics": ("TABLE", "Topic"),
        "space_robot_msgs_py.version": ("__version__",),
    }
    __getattr__, __dir__ = lazy_face(__name__, _MODULES)
