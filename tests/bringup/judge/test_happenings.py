"""Events are called by the same names where an experiment expects them and where a run has them."""

from __future__ import annotations

from typing import Any

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.judge.happenings import entered, known_names, names_of
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_msgs_py.events import DiagnosticEvent

# A run in which everything happens that has a name.
EVERYTHING: dict[str, Any] = {
    "duration": 6.0,
    "plant.monitor": {"limit": {"factor": 1.0}, "rate": {"factor": 0.01, "response": "clip"}},
    "supervision": {
        "modes": {"NOMINAL": {}, "SAFE": {"law": "detumble", "from": ["HOLD"]}, "HOLD": {"reference": "here"}},
        "monitors": [{"name": "tumbling", "value": "base.rate", "above": 0.3, "in": ["NOMINAL", "HOLD"]}],
        "schedule": [{"at": 1.0, "do": "safe"}, {"at": 2.0, "start": "rest"}, {"at": 4.0, "start": "again"}],
        "sequences": {"rest": [{"after": 0.5, "do": "hold"}], "again": [{"after": 0.25, "do": "hold"}]},
    },
    "faults": [
        {"kind": "wrench_pulse", "torque": [0.0, 0.0, 4.0], "at": 3.0, "for": 0.5, "name": "jet"},
        {"kind": "wrench_pulse", "torque": [0.0, 0.0, -4.0], "at": 3.5, "for": 0.5},
        {"kind": "link_drop", "topic": "command", "at": 5.0, "for": 0.5},
    ],
}


def test_a_run_has_no_event_that_could_not_be_expected() -> None:
    """Each of its events has a name, and all names of all events are known before the run."""
    composition = compose(load_experiment("liu2023/fig08", EVERYTHING))
    known = list(known_names(composition.experiment, composition.faults))
    assert len(set(known)) == len(known)
    events = [event for tick in run_in_memory(composition).ticks for event in tick.diagnostics]
    found = {name for event in events for name in names_of(event)}
    assert [event.line for event in events if not set(names_of(event)) & set(known)] == []
    happened = {
        *("jet", "jet begins", "jet ends", "wrench_pulse", "wrench_pulse ends", "link_drop command begins"),
        *("tumbling", "tumbling fires", "tumbling clears", "mode HOLD"),
        *("command safe", "command safe refused", "command hold accepted", "command hold refused"),
        *("sequence rest", "sequence rest starts", "sequence rest ends", "sequence again aborted"),
        *("command missing", "command clipped"),
    }
    assert happened <= found
    assert happened <= set(known)


@pytest.mark.parametrize(
    ("name", "message", "values", "names"),
    [
        ("jet", "begins", {}, ("jet", "jet begins")),
        ("jet", "ends", {}, ("jet ends",)),
        ("fast", "fires", {}, ("fast", "fast fires")),
        ("fast", "clears", {}, ("fast clears",)),
        ("mode", "NOMINAL -> SAFE", {"from": "NOMINAL", "to": "SAFE"}, ("mode SAFE",)),
        ("command", "accepted", {"command": "hold"}, ("command hold", "command hold accepted")),
        ("command", "refused", {"command": "hold"}, ("command hold", "command hold refused")),
        ("sequence", "starts", {"sequence": "rest"}, ("sequence rest", "sequence rest starts")),
        ("sequence", "ends", {"sequence": "rest"}, ("sequence rest ends",)),
        ("sequence", "aborted", {"sequence": "rest"}, ("sequence rest aborted",)),
    ],
)
def test_the_end_of_something_is_not_called_by_its_name_alone(
    name: str, message: str, values: dict[str, str], names: tuple[str, ...]
) -> None:
    """What begins has its name and its name with the message; what ends has the second one only."""
    event = DiagnosticEvent(0, 0, name, message, "", tuple(values.items()))
    assert names_of(event) == names
    assert entered(event) == (values["to"] if name == "mode" else None)


def test_without_supervision_faults_and_monitor_there_is_nothing_to_name() -> None:
    """Each brings its own names."""
    assert list(known_names(load_experiment("liu2023/fig08"), None)) == []
    monitored = load_experiment("liu2023/fig08", {"plant.monitor": {"limit": {"factor": 1.0}}})
    assert list(known_names(monitored, None)) == ["command missing", "command refused", "command clipped"]
