"""What happened in a run is one list and spans of time, read from its log; page, picture and panel show them."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.logs.assessed import read_judged
from space_robot_bringup.logs.happened import Happened, Witness, events_of_log
from space_robot_bringup.logs.info import bag_info
from space_robot_bringup.logs.spans import NO_SPANS, Span, Spans, fault_spans, mode_spans
from space_robot_bringup.modes.headless import run_in_memory, write_bag
from space_robot_cli.main import main
from space_robot_msgs_py.log.reader import LogReader

JET = "<i>jet</i>"
RUN = {
    "duration": 8.0,
    "supervision": "mini_basic",
    "plant.monitor": {"limit": {"factor": 1e-3, "response": "clip"}},
    "expect": {},
    "faults": [
        {"kind": "wrench_pulse", "torque": [0.0, 0.0, 4.0], "at": 4.0, "for": 1.0, "name": JET},
        {"kind": "joint_friction", "joint": "joint2", "coulomb": 0.01, "at": 6.0},
    ],
}


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run in which every source has something to say."""
    composition = compose(load_experiment("liu2023/fig08", RUN))
    place = tmp_path_factory.mktemp("happened") / "run"
    write_bag(run_in_memory(composition), composition, place)
    return place


def test_every_source_is_in_one_list_in_order(bag: Path) -> None:
    """Faults, the plant, the supervisor and the controller, by tick, each with the severity that is its own."""
    witness, trouble = events_of_log(LogReader(bag))
    events = witness.events
    assert (trouble, witness.left_out) == ("", 0)
    assert [event.stamp for event in events] == sorted(event.stamp for event in events)
    found = {(event.source, event.name, event.message): event for event in events}
    assert found["fault", JET, "begins"].severity == "high"
    assert found["fault", JET, "ends"].severity == "info"
    assert found["plant", "command clipped", "limit"].severity == "medium"
    assert found["supervisor", "arm_fast", "fires"].severity == "high"
    assert found["supervisor", "mode", "NOMINAL -> SAFE"].mode == "SAFE"
    assert found["controller", "switch", ""].severity == "info"
    assert read_judged(bag).happened == tuple(events)


def test_modes_and_faults_are_spans(bag: Path) -> None:
    """From the first mode to the last tick; a fault without an end lasts to the end; ``info`` says the same."""
    spans = read_judged(bag).spans
    changed = next(event.time for event in read_judged(bag).happened if event.mode)
    assert spans.modes == (Span("NOMINAL", 0.0, changed), Span("SAFE", changed, 8.0))
    assert spans.faults == (Span(JET, 4.0, 5.0), Span("joint_friction joint2", 6.0, 8.0))
    assert (spans.at(4.1), spans.at(7.9)) == (("NOMINAL", (JET,)), ("SAFE", ("joint_friction joint2",)))
    found = bag_info(bag).verdict
    assert found.spans == spans
    assert list(found.events) == ["high", "medium", "info"]
    assert sum(found.events.values()) == len(read_judged(bag).happened)


def event(at: float, name: str, message: str, **detail: str) -> Happened:
    source = "supervisor" if name == "mode" else "fault"
    return Happened(round(at * 1e9), source, "info", name, message, detail)  # type: ignore[arg-type]


def test_spans_of_odd_events() -> None:
    """An end without a beginning is none; a mode left at once has no length; without supervision there are no modes."""
    assert fault_spans([event(1.0, "a", "ends"), event(2.0, "b", "begins")], 3.0) == [Span("b", 2.0, 3.0)]
    changes = [event(1.0, "mode", "A -> B", to="B"), event(1.0, "mode", "B -> C", to="C")]
    assert mode_spans(changes, "A", 2.0) == [Span("A", 0.0, 1.0), Span("B", 1.0, 1.0), Span("C", 1.0, 2.0)]
    assert Spans.of(changes, None, 2.0) == NO_SPANS


def test_a_log_of_endless_events_is_bounded(monkeypatch: pytest.MonkeyPatch, bag: Path) -> None:
    """The first of them are kept, the others counted."""
    monkeypatch.setattr("space_robot_bringup.logs.happened.MAX_EVENTS", 3)
    witness = Witness(LogReader(bag).rows())
    assert len(list(witness.rows())) == 33
    assert len(witness.events) == 3
    assert witness.left_out > 3


@pytest.mark.parametrize(
    ("options", "sources", "severities"),
    [
        ((), {"fault", "plant", "supervisor", "controller"}, {"info", "medium", "high"}),
        (("--severity", "high"), {"fault", "supervisor"}, {"high"}),
        (("--source", "plant", "--source", "controller"), {"plant", "controller"}, {"info", "medium"}),
        (("--source", "controller", "--severity", "medium"), set(), set()),
    ],
)
def test_the_command_filters(
    bag: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    options: tuple[str, ...],
    sources: set[str],
    severities: set[str],
) -> None:
    """By source and severity, as a table and as JSON."""
    for extra in ((), ("--json",)):
        monkeypatch.setattr(sys, "argv", ["space-robot", "events", str(bag), *options, *extra])
        with pytest.raises(SystemExit) as exit_:
            main()
        assert exit_.value.code == 0
        said = capsys.readouterr().out
        if extra:
            found = json.loads(said)["events"]
            assert {one["source"] for one in found} == sources
            assert {one["severity"] for one in found} == severities
        else:
            assert all(word in said for word in (*sources, *severities))
            assert found_nothing(said) == (not sources)


def found_nothing(said: str) -> bool:
    """Whether a table is left out because there is nothing in it."""
    return said == "no events\n"


def test_what_cannot_be_filtered_by_is_refused(
    bag: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line with what is accepted, exit 2."""
    monkeypatch.setattr(sys, "argv", ["space-robot", "events", str(bag), "--source", "moon"])
    with pytest.raises(SystemExit) as exit_:
        main()
    assert exit_.value.code == 2
    assert "--source: no such choice; got 'moon'; accepted: fault, plant" in capsys.readouterr().err


def test_the_page_shows_bands_spans_and_a_table(bag: Path) -> None:
    """Bands and spans for every plot, a row per event with its severity, and no text of the log as markup."""
    pytest.importorskip("plotly")
    from space_robot_report.pages.log_report import log_page

    page = log_page(read_judged(bag))
    bands = json.loads(page.split('id="bands">')[1].split("</script>")[0])
    assert [(band["fault"], band["begin"]) for band in bands][::3] == [(False, 0.0), (True, 6.0)]
    for words in (
        "What happened",
        "NOMINAL -&gt; SAFE",
        '<span class="tag high">high</span>',
        "&lt;i&gt;jet&lt;/i&gt;",
    ):
        assert words in page
    assert JET not in page


def test_the_panel_shows_bands_and_what_is_on_now(bag: Path) -> None:
    """Strips of modes and faults, the mode and faults at a time, a table; text of the log is text."""
    pytest.importorskip("viser")
    from space_robot_report.viewer import story

    judged = read_judged(bag)
    shown = story.bands(judged.spans, 0.0, 8.0)
    assert "left: 50.000%; width: 12.500%" in shown
    assert story.now(judged.spans, 4.5).startswith("<p><b>")
    assert "fault: &lt;i&gt;jet" in story.now(judged.spans, 4.5)
    assert (story.now(NO_SPANS, 1.0), story.bands(NO_SPANS, 0.0, 1.0)) == ("", "")
    assert JET not in shown + story.table(judged.happened) + story.now(judged.spans, 4.5)


def test_the_picture_has_a_panel_of_modes_and_faults(bag: Path) -> None:
    """Above the others; a run without either has none."""
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    from space_robot_report.figures.log import _draw

    figure = Figure()
    _draw(figure, LogReader(bag))
    assert figure.axes[0].get_title(loc="left") == "mode, faults"
    assert len(figure.axes) == 5
