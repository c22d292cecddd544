"""Campaigns give the same table whatever runs them and whatever dies meanwhile; every case can be run again."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import pytest

from tests.support.paths import ROOT

pq = pytest.importorskip("pyarrow.parquet")
pytest.importorskip("scipy")

from space_robot_cli.main import main  # noqa: E402
from space_robot_studies.campaign.campaign import CampaignResult, run_campaign  # noqa: E402
from space_robot_studies.campaign.spec import load_campaign  # noqa: E402
from space_robot_studies.engine.hooks import StudyHooks  # noqa: E402
from tests.support.follow import DEADLINE, ended  # noqa: E402
from tests.support.nonempty import nonempty  # noqa: E402
from tests.support.processes import descendants  # noqa: E402

pytestmark = pytest.mark.xdist_group("campaign")

# Some of the cases fail: how far the base turns meanwhile depends on what was drawn.
CAMPAIGN = """
title: test
experiment: liu2023/fig08
set:
  duration: 4.0
  expect: {base/pitch.max_error: {max: 6.0}}
runs: 12
seed: 2
disperse:
  initial.attitude_deg: {rotation: {max_deg: 20}}
  plant.payload.mass: {uniform: {low: 0.1, high: 2.0}}
  plant.sensors.attitude.noise: {normal: {mean: 1.0e-3, std: 1.0e-5}}
vary:
  plant.delay_periods: [0, 1]
"""
# Every way in which a law can end a run, between two that are fine.
LAWS = """
title: laws that fail
experiment: liu2023/fig08
set: {duration: 2.0, expect: {}, controller.gains: {}}
runs: 1
vary:
  controller.law:
    fine: computed_torque
    gives up: tests.support.laws:GivesUp
    buggy: tests.support.laws:Buggy
    exits: tests.support.laws:Exits
    deadly: tests.support.laws:Deadly
    leaves: tests.support.laws:Leaves
    endless: tests.support.laws:Endless
    waits: tests.support.laws:Waits
    fine too: computed_torque
"""


def write(folder: Path, text: str = CAMPAIGN) -> Path:
    path = folder / "test.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def run_in(folder: Path, name: str, text: str = CAMPAIGN, **options: Any) -> CampaignResult:
    return run_campaign(write(folder, text), folder / name, **options)


def results(directory: Path) -> list[bytes]:
    """What must be the same: table and summary."""
    return [(directory / name).read_bytes() for name in ("table.parquet", "summary.json")]


def rows(directory: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = pq.read_table(directory / "table.parquet").to_pylist()
    return found


@pytest.fixture(scope="module")
def finished_campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The campaign run by one worker without interruption, every bag kept."""
    folder = tmp_path_factory.mktemp("campaign")
    run_in(folder, "one", workers=1, keep="all")
    return folder / "one"


def wait_for(condition: Callable[[], Any], what: str, seconds: float = DEADLINE) -> None:
    end = monotonic() + seconds
    while not condition():
        assert monotonic() < end, f"waited {seconds} s for {what}"
        sleep(0.01)


def finished(directory: Path) -> int:
    path = directory / "rows.jsonl"
    return max(0, path.read_bytes().count(b"\n") - 1) if path.exists() else 0


@contextmanager
def started(*arguments: str) -> Iterator[subprocess.Popen[str]]:
    """A process in a session of its own that does not outlive the block."""
    process = subprocess.Popen(
        [sys.executable, "-m", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        cwd=ROOT,
        start_new_session=True,
    )
    with ended([process]):
        yield process


@pytest.mark.parametrize("workers", [2, 4])
def test_the_number_of_workers_changes_nothing(finished_campaign: Path, tmp_path: Path, workers: int) -> None:
    """Table and summary are the same bytes with 1, 2 and 4 workers; kept are the bags of the failed cases."""
    result = run_in(tmp_path, "more", workers=workers)
    assert (result.end_reason, result.passed) == ("completed", None)
    assert results(tmp_path / "more") == results(finished_campaign)
    failed = [row["index"] for row in rows(finished_campaign) if not row["passed"]]
    assert 0 < len(failed) < 24
    assert sorted(path.name for path in (tmp_path / "more" / "runs").iterdir()) == [f"{k:06d}" for k in failed]


def test_a_row_says_what_was_drawn_and_what_came_of_it(finished_campaign: Path) -> None:
    """Rows are in order, both points of the grid got the same draws, and failures are named."""
    table = rows(finished_campaign)
    assert [row["index"] for row in table] == list(range(24))
    for one, other in zip(table[::2], table[1::2], strict=True):
        assert (one["plant.delay_periods"], other["plant.delay_periods"]) == (0, 1)
        for key in ("run", "seed", "initial.attitude_deg.0", "plant.payload.mass", "plant.sensors.attitude.noise"):
            assert one[key] == other[key]
    assert all(row["completed"] and row["ticks"] == 17 for row in table)
    assert {row["failed"] for row in table} == {"", "base/pitch.max_error"}


@pytest.mark.parametrize("mode", ["headless", pytest.param("graph", marks=pytest.mark.ros)])
def test_a_case_run_again_has_the_numbers_of_its_row(
    finished_campaign: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    mode: str,
) -> None:
    """`run --from DIR --index K` gives every number of the row and the bytes of the kept log, in the graph too."""
    if mode == "graph":
        pytest.importorskip("rclpy")
    index = next(row["index"] for row in rows(finished_campaign) if row["passed"] and row["plant.delay_periods"] == 1)
    out, options = tmp_path / "again", ([] if mode == "graph" else ["--mode", mode])
    command = [
        "space-robot",
        "run",
        "--from",
        str(finished_campaign),
        "--index",
        str(index),
        "--out",
        str(out),
        "--json",
    ]
    monkeypatch.setattr(sys, "argv", command + options)
    with pytest.raises(SystemExit) as end:
        main()
    said = json.loads(capsys.readouterr().out)
    assert end.value.code == 0
    assert (said["mode"], said["differences"]) == (mode, [])
    row = rows(finished_campaign)[index]
    assert {name: row[name] for name in said["metrics"]} == said["metrics"]
    assert len(said["metrics"]) > 30
    kept = finished_campaign / "runs" / f"{index:06d}" / f"{index:06d}_0.mcap"
    assert (out / "again_0.mcap").read_bytes() == kept.read_bytes()


def test_a_kill_of_a_worker_and_of_the_campaign_changes_nothing(tmp_path: Path) -> None:
    """A killed worker costs no row; a killed campaign leaves no process; resumed, its table is whole."""
    text = CAMPAIGN.replace("runs: 12", "runs: 80")
    write(tmp_path, text)
    out = tmp_path / "killed"
    command = ["space_robot_cli", "campaign", str(tmp_path / "test.yaml"), "--out", str(out), "--workers", "2"]
    with started(*command) as campaign:
        wait_for(lambda: finished(out) >= 2, "the first rows")
        (spawner,) = descendants(campaign.pid, 1)
        os.kill(descendants(spawner, 1)[0], signal.SIGKILL)
        before = finished(out)
        wait_for(lambda: finished(out) > before + 2, "rows after a worker's death")
        processes = descendants(campaign.pid)
        assert len(processes) == 3
        campaign.kill()
        campaign.wait()
        wait_for(lambda: not any(Path(f"/proc/{pid}").exists() for pid in processes), "the workers to go too")
    assert 2 <= finished(out) < 160
    assert not (out / "table.parquet").exists()
    lost = [json.loads(line) for line in (out / "rows.jsonl").read_text().splitlines()[1:] if '"lost": true' in line]
    assert lost == []
    result = run_in(tmp_path, "killed", text, workers=2, resume=True)
    assert (result.done, result.total, result.lost) == (160, 160, 0)
    run_in(tmp_path, "whole", text, workers=2)
    assert results(out) == results(tmp_path / "whole")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_campaign_and_says_how_to_go_on(tmp_path: Path, number: signal.Signals) -> None:
    """A signal that reaches workers too ends it with exit 1, its rows kept, no process left, no traceback."""
    write(tmp_path, CAMPAIGN.replace("runs: 12", "runs: 1000"))
    out = tmp_path / "stopped"
    command = ["space_robot_cli", "campaign", str(tmp_path / "test.yaml"), "--out", str(out), "--workers", "1"]
    with started(*command) as campaign:
        wait_for(lambda: finished(out) >= 2, "the first rows")
        processes = descendants(campaign.pid)
        os.killpg(campaign.pid, number)
        said, _ = campaign.communicate(timeout=DEADLINE)
    assert campaign.returncode == 1, said
    assert ("FAIL (interrupted)" if number == signal.SIGINT else "FAIL (terminated)") in said
    assert f"space-robot campaign {out / 'resolved.yaml'} --out {out} --resume" in said
    assert "Traceback" not in said, said
    assert 2 <= finished(out) < 2000
    assert len(processes) == 2
    assert not any(Path(f"/proc/{pid}").exists() for pid in processes)


def test_a_scheduler_elsewhere_gives_the_same_table(
    finished_campaign: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A scheduler and two workers, processes of their own, run it to the same bytes; lost, they end it."""
    distributed = pytest.importorskip("distributed")
    from space_robot_studies.engine import dask_workers

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    options = ["--no-dashboard", "--dashboard-address", "127.0.0.1:0"]
    scheduler = ["distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", address.rpartition(":")[2]]
    worker = ["distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny", *options]
    with started(*scheduler, *options) as post, started(*worker) as one, started(*worker) as two:

        def wait_for_workers(count: int) -> None:
            with distributed.Client(address, timeout=30) as client:
                client.wait_for_workers(count, timeout=DEADLINE)

        wait_for_workers(2)
        result = run_in(tmp_path, "far", scheduler=address, keep="all")
        assert (result.end_reason, result.passed) == ("completed", None)
        assert results(tmp_path / "far") == results(finished_campaign)
        for bag in nonempty(finished_campaign.glob("runs/*/*")):
            assert (tmp_path / "far" / bag.relative_to(finished_campaign)).read_bytes() == bag.read_bytes()
        run_in(tmp_path, "deadly", without("endless", "waits"), scheduler=address)
        assert reasons(tmp_path / "deadly") == {law: REASONS[law] for law in REASONS if law not in ("endless", "waits")}
        monkeypatch.setattr(dask_workers, "PATIENCE_SECONDS", 0.5)
        monkeypatch.setattr(dask_workers, "FETCH_SECONDS", 2.0)
        endless = load_campaign(write(tmp_path, CAMPAIGN.replace("runs: 12", "runs: 1000")))

        def end_after_a_row(name: str, *victims: subprocess.Popen[str]) -> str:
            hooks = StudyHooks(on_row=lambda done: [victim.kill() for victim in victims] and None)
            ended = run_campaign(endless, tmp_path / name, scheduler=address, hooks=hooks)
            assert 0 < ended.done < ended.total
            return ended.end_reason

        assert "no worker is left" in end_after_a_row("no worker", one, two)
        with started(*worker):
            wait_for_workers(1)
            assert "the scheduler is gone" in end_after_a_row("no scheduler", post)


LIMIT = 2.0
REASONS = {
    "fine": "completed",
    "gives up": "controller: gives_up: patience: enough at t = 0.5 s",
    "buggy": "bug: KeyError: 'a typo'",
    "exits": "controller: law exits at tick 2: SystemExit: enough of this",
    "deadly": "lost: the worker process was killed by SIGKILL",
    "leaves": "lost: the worker process exited with status 7",
    "endless": "timeout: more than 2 s of CPU time",
    "waits": "timeout: more than 20 s, most of them waiting",
    "fine too": "completed",
}


def without(*laws: str) -> str:
    """The campaign of failing laws without some of them."""
    return "\n".join(line for line in LAWS.splitlines() if not line.strip().startswith(laws))


def reasons(directory: Path) -> dict[str, str]:
    return {row["controller.law"]: row["end_reason"] for row in rows(directory)}


def test_a_failing_law_costs_one_row_of_its_campaign(tmp_path: Path) -> None:
    """A law that gives up, raises, exits, kills its process, loops or waits for ever costs one row with the reason."""
    result = run_in(tmp_path, "bad", LAWS, workers=2, time_limit=LIMIT)
    assert (result.end_reason, result.passed, result.lost) == ("completed", False, 2)
    assert reasons(tmp_path / "bad") == REASONS
    table = rows(tmp_path / "bad")
    assert [row["index"] for row in table if row["completed"]] == [0, 8]
    gives_up = table[1]
    assert gives_up["ticks"] == 2
    assert gives_up["base/roll.max_error"] is not None
    assert sorted(path.name for path in (tmp_path / "bad" / "runs").iterdir()) == ["000001", "000002", "000003"]
    journal = [json.loads(line) for line in (tmp_path / "bad" / "rows.jsonl").read_text().splitlines()[1:]]
    assert "KeyError" in next(row["trace"] for row in journal if row["key"] == 2)
    assert {row["key"] for row in journal if row["lost"]} == {4, 5}
    assert {row["key"]: row["time_limit"] for row in journal if row["time_limit"]} == {6: LIMIT, 7: LIMIT}


def test_a_resumed_campaign_runs_again_what_may_end_otherwise(tmp_path: Path) -> None:
    """Lost runs are run again, those ended by a limit only under a larger one, all others never."""
    run_in(tmp_path, "out", without("leaves", "waits"), workers=2, time_limit=2.0)
    for limit, again in ((2.0, [4]), (2.5, [4, 5])):
        before = finished(tmp_path / "out")
        run_in(tmp_path, "out", without("leaves", "waits"), workers=2, time_limit=limit, resume=True)
        lines = (tmp_path / "out" / "rows.jsonl").read_text().splitlines()[1 + before :]
        assert sorted(json.loads(line)["key"] for line in lines) == again


def test_output_of_a_law_stays_out_of_the_json(tmp_path: Path) -> None:
    """`--json` prints one object, whatever the laws of the runs say."""
    path = write(tmp_path, LAWS[: LAWS.index("    fine:")] + "    talks: tests.support.laws:Talks\n")
    command = [sys.executable, "-m", "space_robot_cli", "campaign", str(path), "--json", "--out", str(tmp_path / "out")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert json.loads(done.stdout)["done"] == 1
    assert "hear me" in done.stderr
