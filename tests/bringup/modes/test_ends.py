"""Every end of a run has one reason, the same in every mode, and only a whole run passes."""

from __future__ import annotations

import resource
import shutil
import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.judge.verdict import check_ticks
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.run import Mode, RunResult, judge_log, run_experiment
from space_robot_bringup.modes.signals import RunStop
from space_robot_control.laws.guarded import LawError
from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.run_directory import RunDirectory
from space_robot_msgs_py.log.writer import LogSink

MODES = [
    "headless",
    pytest.param("graph", marks=[pytest.mark.ros, pytest.mark.xdist_group("graph")]),
    pytest.param("processes", marks=[pytest.mark.ros, pytest.mark.xdist_group("graph")]),
]
QUICK = MODES[:2]


def run_mode(place: Path, mode: Mode, *overrides: str, hooks: Hooks | None = None) -> RunResult:
    if mode != "headless":
        pytest.importorskip("rclpy")
    return run_experiment(load_experiment("liu2023/fig08", overrides), place, mode=mode, hooks=hooks)


@pytest.mark.parametrize("mode", MODES)
def test_any_exception_of_a_law_ends_the_run_with_one_line(tmp_path: Path, mode: Mode) -> None:
    """The reason names the law, the tick and the cause, ``SystemExit`` too, and is the log's; the log has the state."""
    failures: list[BaseException] = []
    hooks = Hooks(on_failure=failures.append)
    result = run_mode(tmp_path / "run", mode, "controller.law=tests.support.laws:Exits", "duration=5.0", hooks=hooks)
    assert result.end_reason == "controller: law exits at tick 2: SystemExit: enough of this"
    assert LogReader(tmp_path / "run").end_reason == result.end_reason
    assert not result.passed
    missing = next(check for check in result.checks if check.name == "ticks")
    assert (missing.measured, missing.passed) == (2.0, False)
    assert missing.wanted.endswith("tick 2 at 0.5 s has no command of the law tests.support.laws:Exits")
    if mode != "processes":
        assert [type(failure) for failure in failures] == [LawError]
        assert isinstance(failures[0].__cause__, SystemExit)


@pytest.mark.parametrize("law", ["Endless", "Asleep"])
@pytest.mark.parametrize("mode", QUICK)
def test_a_law_that_hangs_is_ended_by_the_limit(
    tmp_path: Path, mode: Mode, law: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A limit on time ends a law that never comes back; the log is closed with that reason and names the tick."""
    monkeypatch.setattr("space_robot_bringup.modes.signals.GRACE_SECONDS", 0.2)
    experiment = load_experiment("liu2023/fig08", [f"controller.law=tests.support.laws:{law}", "duration=5.0"])
    if mode != "headless":
        pytest.importorskip("rclpy")
    with RunStop(signal.SIGINT, timeout=2.0) as stop:
        hooks = Hooks(stop.reach, stop=lambda: stop.reason, on_end=lambda reason: stop.lift())
        result = run_experiment(experiment, tmp_path / "run", mode=mode, hooks=hooks)
    assert result.end_reason == LogReader(tmp_path / "run").end_reason == "timeout"
    assert next(check.wanted for check in result.checks if check.name == "ticks").endswith(
        f"tick 2 at 0.5 s has no command of the law tests.support.laws:{law}"
    )
    assert not result.passed


def gone(run: Path) -> None:
    shutil.rmtree(run)


def full(run: Path) -> None:
    """The disk takes no more: no file of this process may grow by more than one tick."""
    size = (run / "run_0.mcap").stat().st_size
    resource.setrlimit(resource.RLIMIT_FSIZE, (size + 2000, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))


def in_the_way(run: Path) -> None:
    (run / "run_0.mcap.tmp").mkdir()


SAID = {gone: "it was deleted, moved or replaced", full: "File too large", in_the_way: "Is a directory"}
CASES = [pytest.param(mode, fault, id=f"{mode} {fault.__name__}") for mode in ("headless", "graph") for fault in SAID]


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
@pytest.mark.parametrize(("mode", "fault"), [*CASES, pytest.param("processes", gone, id="processes gone")])
def test_a_log_that_cannot_be_written_ends_the_run(tmp_path: Path, mode: Mode, fault: Callable[[Path], None]) -> None:
    """Deleted, full, or not to be finished: one reason in every mode, never a pass, nothing temporary left."""
    run, begun, reached = tmp_path / "run", [False], [0]

    def on_tick(tick: int) -> None:
        reached[0] = tick
        if tick >= 5 and not begun[0]:
            begun[0] = True
            fault(run)

    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    duration = "duration=25.0" if fault is in_the_way else "duration=2500.0"
    try:
        result = run_mode(run, mode, duration, hooks=Hooks(on_tick=on_tick))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert result.end_reason.startswith(f"recorder: {run / 'run_0.mcap'}: the log cannot be written: ")
    assert SAID[fault] in result.end_reason
    assert not result.passed
    assert not [path for path in tmp_path.rglob("*.tmp") if path.is_file()]
    assert reached[0] < 5000
    if fault is in_the_way:
        assert LogReader(run).end_reason == result.end_reason


@pytest.mark.parametrize("mode", MODES)
def test_two_runs_never_share_a_directory(tmp_path: Path, mode: Mode) -> None:
    """The second run into a directory that is written to is refused before it runs, and touches nothing."""
    with RunDirectory(tmp_path / "run") as place:
        place.bag.write_bytes(b"of the first")
        with pytest.raises(LogError, match="another run is writing here"):
            run_mode(tmp_path / "run", mode)
        assert place.bag.read_bytes() == b"of the first"


def test_a_run_that_cannot_be_made_leaves_no_directory(tmp_path: Path) -> None:
    """Where nothing was run, no empty run directory stays, and an earlier run stays as it is."""
    composition = compose(load_experiment("liu2023/fig08", ["duration=1.0"]))
    LogSink(tmp_path / "old", composition.header).close("completed")
    kept = (tmp_path / "old" / "old_0.mcap").read_bytes()
    for name in ("old", "new"):
        with pytest.raises(LookupError), RunDirectory(tmp_path / name):
            raise LookupError
    assert [path.name for path in tmp_path.iterdir()] == ["old"]
    assert (tmp_path / "old" / "old_0.mcap").read_bytes() == kept


T = 250_000_000


@pytest.mark.parametrize(
    ("stamps", "passed", "said"),
    [
        ([0, T, 2 * T, 3 * T], True, "4 complete ticks up to 0.75 s"),
        ([0, T, 2 * T], False, "tick 3 at 0.75 s is not complete"),
        ([0, 2 * T, 3 * T], False, "tick 1 at 0.25 s is not complete"),
        ([T, 2 * T, 3 * T], False, "tick 0 at 0 s is not complete"),
        ([0, T, 2 * T, 3 * T, 4 * T], False, "4 complete ticks up to 0.75 s"),
        ([], False, "tick 0 at 0 s is not complete"),
    ],
)
def test_a_whole_run_has_every_tick_and_no_other(stamps: list[int], passed: bool, said: str) -> None:
    """Ticks 0..N and nothing else; what is missing first is named."""
    check = check_ticks(stamps, 3, T)
    assert (check.passed, check.measured) == (passed, len(stamps))
    assert said in check.wanted


@pytest.mark.parametrize(
    ("closed", "kept", "said", "expected"),
    [
        ("completed", 5, "completed", ("completed", True)),
        ("completed", 4, "completed", ("completed", False)),
        ("reset", 5, "completed", ("reset", False)),
        (None, 5, "completed", ("truncated", False)),
        (None, 4, "interrupted", ("interrupted", False)),
        ("completed", 5, "recorder: no", ("recorder: no", False)),
    ],
)
def test_the_verdict_is_about_what_is_in_the_log(
    tmp_path: Path, closed: str | None, kept: int, said: str, expected: tuple[str, bool]
) -> None:
    """A run passes where its log has every tick and says itself that it was completed, whatever else is claimed."""
    composition = compose(load_experiment("liu2023/fig08", ["duration=1.0", "expect={base/roll.max_error: {max: 20}}"]))
    whole = run_experiment(composition.experiment, tmp_path / "whole", mode="headless")
    assert whole.passed
    sink = LogSink(tmp_path / "run", composition.header)
    for tick in list(LogReader(tmp_path / "whole").ticks())[:kept]:
        sink.record(tick)
    # As a kill would leave it: what is there before it is closed.
    shutil.copytree(tmp_path / "run", tmp_path / "cut")
    sink.close(closed or "never read")
    result = judge_log(tmp_path / ("run" if closed else "cut"), composition, said, 0.0)
    assert (result.end_reason, result.passed) == expected


def test_a_log_that_is_gone_is_a_failed_run(tmp_path: Path) -> None:
    """Where there is no log to judge, the run failed and says why; nothing is raised."""
    composition = compose(load_experiment("liu2023/fig08", ["duration=1.0"]))
    result = judge_log(tmp_path / "nowhere", composition, "completed", 0.0)
    assert result.end_reason.startswith("recorder: ")
    assert "no such file" in result.end_reason
    assert (result.passed, result.metrics) == (False, None)
