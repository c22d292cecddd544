"""`space_robot.run` and what it returns: the run of the command line, as an object."""

from __future__ import annotations

import gc
import sys
import tempfile
import warnings
from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path

import numpy as np
import pytest

import space_robot as sr
from space_robot_bringup.experiment.experiment import experiment_path
from space_robot_cli.main import main
from space_robot_msgs_py import InputFileError, SpecError
from tests.support.short_run import CHANGES, NAME, TEXTS


def bits(run: sr.Run) -> bytes:
    """What is in its log."""
    return run.log.path.read_bytes()


@pytest.mark.parametrize(
    "again",
    [
        lambda: sr.run(NAME, TEXTS),
        lambda: sr.run(NAME, {"controller.gains.lambda": np.float32(0.7).item()} | CHANGES, mode="headless"),
        lambda: sr.run(NAME, TEXTS[1:], duration=2.0),
        lambda: sr.run(experiment_path(NAME), CHANGES),
        lambda: sr.run(str(experiment_path(NAME)), CHANGES),
        lambda: sr.run(sr.load_experiment(NAME), CHANGES),
        lambda: sr.run(sr.load_experiment(NAME, CHANGES)),
        lambda: sr.run(sr.load_experiment(experiment_path(NAME), TEXTS), duration=2.0),
    ],
)
def test_every_way_to_say_an_experiment_gives_the_same_bits(run: sr.Run, again: Callable[[], sr.Run]) -> None:
    """Name, text, Path or a loaded experiment; mapping, texts or arguments: the log is the same file."""
    assert bits(again()) == bits(run)


def test_a_run_from_python_equals_that_of_the_command_line(
    run: sr.Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``space-robot run`` with the same options writes the same log."""
    settings = [word for text in TEXTS for word in ("--set", text)]
    monkeypatch.setattr(sys, "argv", ["space-robot", "run", NAME, "--out", str(tmp_path / "cli"), *settings])
    with pytest.raises(SystemExit):
        main()
    assert sr.LogReader(tmp_path / "cli").path.read_bytes() == bits(run)


def test_the_graph_gives_the_same_bits(run: sr.Run, tmp_path: Path) -> None:
    """The mode changes no bit of the log."""
    pytest.importorskip("rclpy")
    assert bits(sr.run(NAME, CHANGES, mode="graph", out=tmp_path / "graph")) == bits(run)


def test_a_run_has_reason_verdict_and_metrics_of_its_log(run: sr.Run) -> None:
    """Reason, verdict and metrics are those of the log; two seconds are too short to settle."""
    assert (run.reason, run.passed) == ("completed", False)
    assert run.reason == run.log.end_reason
    assert run.metrics is not None
    assert run.metrics.ticks == 9
    assert [check.name for check in run.verdict][:3] == ["completed", "ticks", "momentum_residual"]
    assert run.passed == all(check.passed for check in run.verdict)
    assert run.joint_names == ("joint1", "joint2", "joint3", "joint4")
    assert run.experiment.controller.gains["lambda"] == 0.7
    assert repr(run).startswith("<Run 'Orientation")
    assert "FAIL (completed), 9 ticks" in repr(run)


@pytest.mark.parametrize(
    ("module", "call", "extra"),
    [
        ("pandas", lambda run: run.to_pandas(), r"to_pandas needs more packages .*space-robot\[pandas\]"),
        ("matplotlib.figure", lambda run: run.plot(), r"plot needs more packages .*space-robot\[viz\]"),
    ],
)
def test_a_missing_package_names_its_extra(
    run: sr.Run, monkeypatch: pytest.MonkeyPatch, module: str, call: Callable[[sr.Run], object], extra: str
) -> None:
    """What needs more than the installation has says what to install."""
    (figure,) = entry_points(group="space_robot.figures", name="run")
    monkeypatch.delitem(sys.modules, figure.module, raising=False)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(SpecError, match=extra):
        call(run)


def test_a_run_is_a_path(run: sr.Run) -> None:
    """Wherever a run directory is wanted, the run itself will do."""
    assert Path(run) == run.directory
    assert sr.replay(run).equal
    assert sr.LogReader(run).header == run.log.header


def test_a_replay_with_an_override_is_not_equal(run: sr.Run) -> None:
    """Another gain gives other commands; recorded states and a plant of their own stay as they are."""
    done = sr.replay(str(run.directory), {"controller.gains.lambda": 0.8})
    assert [outcome.equal for outcome in done.outcomes] == [False, True]
    assert sr.replay(run.directory, TEXTS[1:], against="controller").equal
    assert sr.replay(run, {"controller.gains.lambda": 0.8}, atol=10.0, ignore="controller/telemetry").equal


def test_a_log_brings_no_code_into_a_replay(tmp_path: Path) -> None:
    """A law that is not installed is imported for a run of this process, or where the caller says so."""
    law = "tests.support.laws:GivesUp"
    one = sr.run(NAME, {"controller.law": law}, out=tmp_path / "one")
    with pytest.raises(sr.SpaceRobotError, match="names code"):
        sr.replay(one.directory, against="controller")
    assert sr.replay(one, against="controller").equal
    assert sr.replay(one.directory, against="controller", law=law).equal
    assert sr.replay(one.directory, against="controller", allow_code=True).equal


def test_a_temporary_log_lives_as_long_as_it_is_read() -> None:
    """Without ``out`` the directory is there while the run or its log is, and gone afterwards."""
    one = sr.run(NAME, CHANGES)
    directory, log = one.directory, one.log
    del one
    gc.collect()
    assert len([*log.ticks()]) == 9
    del log
    gc.collect()
    assert not directory.exists()


def test_a_relative_out_is_resolved_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A relative ``out`` is a place, also after the working directory has changed; what is in it stays unless asked."""
    monkeypatch.chdir(tmp_path)
    first = sr.run(NAME, CHANGES, out="runs/one")
    with pytest.raises(sr.SpaceRobotError, match="out: holds a run already"):
        sr.run(NAME, CHANGES | {"seed": 5}, out="runs/one")
    assert sr.LogReader(first.directory).header.seed == first.log.header.seed
    second = sr.run(NAME, CHANGES | {"seed": 5}, out=Path("runs") / "one", overwrite=True)
    monkeypatch.chdir("/")
    assert first.directory == second.directory == tmp_path / "runs" / "one"
    assert second.log.header.seed == 5
    del first, second
    gc.collect()
    assert (tmp_path / "runs" / "one" / "one_0.mcap").is_file()


def test_a_run_that_ends_early_is_a_result(tmp_path: Path) -> None:
    """A law that gives up ends the run with its reason; what was completed until then can be read."""
    ended = sr.run(NAME, {"controller.law": "tests.support.laws:GivesUp"})
    assert ended.reason.startswith("controller: gives_up: patience: enough")
    assert not ended.passed
    assert len(ended.arrays.time) == 2
    (tmp_path / "never.py").write_text(_NEVER, encoding="utf-8")
    never = sr.run(NAME, {"controller.law": f"{tmp_path}/never.py:Never"})
    assert (never.metrics, never.passed) == (None, False)
    assert [(check.name, check.passed) for check in never.verdict] == [("completed", False), ("ticks", False)]
    assert never.arrays.joints.position.shape == (0, 4)
    with pytest.raises(sr.SpaceRobotError, match="nothing to draw"):
        never.plot()


def test_a_run_that_cannot_begin_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bad input leaves no temporary directory behind; a law with a bug ends its run with the cause as the reason."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.raises(SpecError, match=r"controller\.gains\.lamda: unknown key"):
        sr.run(NAME, {"controller.gains.lamda": 0.7})
    assert [*tmp_path.iterdir()] == []
    assert "KeyError: 'a typo'" in sr.run(NAME, {"controller.law": "tests.support.laws:Buggy"}).reason


REFUSED: list[tuple[Callable[[], object], type[Exception], str]] = [
    (lambda: sr.run(NAME, mode="grap"), SpecError, r"^mode: no such mode; got 'grap'; accepted: headless"),  # type: ignore[arg-type]
    (lambda: sr.run(NAME, realtime=2.0), SpecError, r"^realtime: has no wall clock; got 2\.0; accepted: mode graph"),
    (lambda: sr.run(NAME, mode="graph", realtime=float("nan")), SpecError, r"^realtime: not a usable factor; got nan"),
    (lambda: sr.run(NAME, duration=-1.0), SpecError, r"^duration: not accepted; got -1\.0"),
    (lambda: sr.run(NAME, ["duration"]), SpecError, r"^overrides: not an assignment; got 'duration'"),
    (lambda: sr.run(NAME, {"contol_period": 1}), SpecError, r"contol_period: unknown key; .*control_period"),
    (lambda: sr.run(sr.load_experiment(NAME), {"contol_period": 1}), SpecError, r"^contol_period: unknown key"),
    (lambda: sr.run("liu2023/fig80"), InputFileError, r"^experiment: no such .*; got 'liu2023/fig80'; .*liu2023/fig08"),
    (lambda: sr.run(NAME, out="/proc/no/run"), sr.SpaceRobotError, r"/proc/no/run"),
    (lambda: sr.replay("/nowhere"), InputFileError, r"/nowhere"),
    (lambda: sr.replay("/nowhere", against="all"), SpecError, r"^against: no such side; got 'all'"),  # type: ignore[arg-type]
    (lambda: sr.replay("/nowhere", rtol=-1.0), SpecError, r"^rtol: not a tolerance; got -1\.0"),
    (lambda: sr.replay("/nowhere", ignore=["x"]), SpecError, r"^ignore: no such topic; got 'x'"),
]


@pytest.mark.parametrize(("call", "kind", "said"), REFUSED)
def test_bad_arguments_are_named_as_typed(call: Callable[[], object], kind: type[Exception], said: str) -> None:
    """One line with the argument, the value and what is accepted; never an option of the command line."""
    with pytest.raises(kind, match=said) as caught:
        call()
    assert "--" not in str(caught.value)


def test_a_law_warns_of_a_run_outside_its_bounds() -> None:
    """What the command line prints is a Python warning that points at the caller, and the run goes on."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        run = sr.run(NAME, {"controller.gains.lambda": 7.9, "duration": 0.5})
    assert [warning.category for warning in caught] == [sr.SpaceRobotWarning]
    assert caught[0].filename == __file__
    assert run.metrics is not None


_NEVER = """
from space_robot import Law
from space_robot_msgs_py import ControlError

class Never(Law):
    name = "never"

    def compute(self, state, reference):
        raise ControlError("no", key="patience")
"""
