"""Campaigns give the same table whoever flies them, whatever dies meanwhile, and every case can be flown again."""

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

pytest.importorskip("distributed")
pq = pytest.importorskip("pyarrow.parquet")

import dask  # noqa: E402
from distributed import Client  # noqa: E402

from space_robot_cli.main import main  # noqa: E402
from space_robot_studies.campaign import dispatch as fleet  # noqa: E402
from space_robot_studies.campaign.campaign import CampaignHooks, CampaignResult, run_campaign  # noqa: E402
from space_robot_studies.campaign.spec import load_campaign  # noqa: E402
from tests.support.nonempty import nonempty  # noqa: E402

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
LAWS = """
title: laws that fail
experiment: liu2023/fig08
set: {duration: 2.0, expect: {}, controller.gains: {}}
runs: 1
vary:
  controller.law: {fine: computed_torque, {LAWS}}
"""


def write(folder: Path, text: str = CAMPAIGN) -> Path:
    path = folder / "test.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def fly(folder: Path, name: str, text: str = CAMPAIGN, **options: Any) -> CampaignResult:
    return run_campaign(load_campaign(str(write(folder, text))), folder / name, **options)


def results(directory: Path) -> list[bytes]:
    """What must be the same: table and summary."""
    return [(directory / name).read_bytes() for name in ("table.parquet", "summary.json")]


def rows(directory: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = pq.read_table(directory / "table.parquet").to_pylist()
    return found


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The campaign flown by one worker without interruption, every bag kept."""
    folder = tmp_path_factory.mktemp("campaign")
    fly(folder, "one", workers=1, keep="all")
    return folder / "one"


def wait_for(condition: Callable[[], Any], what: str, seconds: float = 60.0) -> None:
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
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def workers_of(process: subprocess.Popen[str]) -> list[int]:
    """The worker processes of a campaign."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            if parent == process.pid and b"spawn_main" in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
        except OSError:
            continue
    return found


@pytest.mark.parametrize("workers", [2, 4])
def test_the_number_of_workers_changes_nothing(flown: Path, tmp_path: Path, workers: int) -> None:
    """Table and summary are the same bytes with 1, 2 and 4 workers; kept are the bags of the failed cases."""
    result = fly(tmp_path, "more", workers=workers)
    assert result.passed
    assert results(tmp_path / "more") == results(flown)
    failed = [row["index"] for row in rows(flown) if not row["passed"]]
    assert 0 < len(failed) < 24
    assert sorted(path.name for path in (tmp_path / "more" / "runs").iterdir()) == [f"{k:06d}" for k in failed]


def test_a_row_says_what_was_drawn_and_what_came_of_it(flown: Path) -> None:
    """Rows are in order, both points of the grid got the same draws, and failures are named."""
    table = rows(flown)
    assert [row["index"] for row in table] == list(range(24))
    for one, other in zip(table[::2], table[1::2], strict=True):
        assert (one["plant.delay_periods"], other["plant.delay_periods"]) == (0, 1)
        for key in ("run", "seed", "initial.attitude_deg.0", "plant.payload.mass", "plant.sensors.attitude.noise"):
            assert one[key] == other[key]
    assert all(row["completed"] and row["ticks"] == 17 for row in table)
    assert {row["failed"] for row in table} == {"", "base/pitch.max_error"}


@pytest.mark.parametrize("mode", ["headless", pytest.param("graph", marks=pytest.mark.ros)])
def test_a_case_flown_again_has_the_numbers_of_its_row(
    flown: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], mode: str
) -> None:
    """`run --from DIR --index K` gives every number of the row and the bytes of the kept log, in the graph too."""
    if mode == "graph":
        pytest.importorskip("rclpy")
    index = next(row["index"] for row in rows(flown) if row["passed"] and row["plant.delay_periods"] == 1)
    out, options = tmp_path / "again", ([] if mode == "graph" else ["--mode", mode])
    command = ["space-robot", "run", "--from", str(flown), "--index", str(index), "--out", str(out), "--json"]
    monkeypatch.setattr(sys, "argv", command + options)
    with pytest.raises(SystemExit) as end:
        main()
    said = json.loads(capsys.readouterr().out)
    assert end.value.code == 0
    assert (said["mode"], said["differences"]) == (mode, [])
    row = rows(flown)[index]
    assert {name: row[name] for name in said["metrics"]} == said["metrics"]
    assert len(said["metrics"]) > 30
    kept = flown / "runs" / f"{index:06d}" / f"{index:06d}_0.mcap"
    assert (out / "again_0.mcap").read_bytes() == kept.read_bytes()


def test_a_kill_of_a_worker_and_of_the_campaign_changes_nothing(flown: Path, tmp_path: Path) -> None:
    """After SIGKILL of a worker, then of the campaign, no worker is left and --resume ends with the same table."""
    write(tmp_path)
    out = tmp_path / "killed"
    command = ["space_robot_bringup", "campaign", str(tmp_path / "test.yaml"), "--out", str(out), "--workers", "2"]
    with started(*command) as campaign:
        wait_for(lambda: finished(out) >= 2, "the first rows")
        os.kill(workers_of(campaign)[0], signal.SIGKILL)
        before = finished(out)
        wait_for(lambda: finished(out) > before + 2, "rows after a worker's death")
        crew = workers_of(campaign)
        campaign.kill()
        campaign.wait()
        wait_for(lambda: not any(Path(f"/proc/{pid}").exists() for pid in crew), "the workers to go too")
    assert 2 <= finished(out) < 24
    assert not (out / "table.parquet").exists()
    result = fly(tmp_path, "killed", workers=2, resume=True)
    assert result.done == result.total == 24
    assert results(out) == results(flown)


def test_a_signal_keeps_the_rows_and_says_how_to_go_on(tmp_path: Path) -> None:
    """Ctrl-C, which reaches workers too, ends a campaign with exit 1, its rows kept and no traceback."""
    write(tmp_path, CAMPAIGN.replace("runs: 12", "runs: 1000"))
    out = tmp_path / "stopped"
    command = ["space_robot_bringup", "campaign", str(tmp_path / "test.yaml"), "--out", str(out), "--workers", "1"]
    with started(*command) as campaign:
        wait_for(lambda: finished(out) >= 2, "the first rows")
        os.killpg(campaign.pid, signal.SIGINT)
        said, _ = campaign.communicate(timeout=60)
    assert campaign.returncode == 1, said
    assert "FAIL (interrupted)" in said
    assert f"space-robot campaign {out / 'resolved.yaml'} --out {out} --resume" in said
    assert "Traceback" not in said, said
    assert 2 <= finished(out) < 2000


def test_a_scheduler_elsewhere_gives_the_same_table(
    flown: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A scheduler and two workers, processes that know nothing of us, fly it to the same bytes; lost, they end it."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    options = ["--no-dashboard", "--dashboard-address", "127.0.0.1:0"]
    scheduler = ["distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", address.rpartition(":")[2]]
    worker = ["distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny", *options]
    with started(*scheduler, *options) as post, started(*worker) as one, started(*worker) as two:

        def wait_for_workers(count: int) -> None:
            with Client(address, timeout=30) as client:
                client.wait_for_workers(count, timeout=60)

        wait_for_workers(2)
        result = fly(tmp_path, "far", workers=0, scheduler=address, keep="all")
        assert result.passed
        assert results(tmp_path / "far") == results(flown)
        for bag in nonempty(flown.glob("runs/*/*")):
            assert (tmp_path / "far" / bag.relative_to(flown)).read_bytes() == bag.read_bytes()
        monkeypatch.setattr(fleet, "PATIENCE_SECONDS", 0.5)
        monkeypatch.setattr(fleet, "FETCH_SECONDS", 2.0)
        endless = load_campaign(str(write(tmp_path, CAMPAIGN.replace("runs: 12", "runs: 1000"))))

        def end_after_a_row(name: str, *victims: subprocess.Popen[str]) -> str:
            hooks = CampaignHooks(on_row=lambda done: [victim.kill() for victim in victims] and None)
            ended = run_campaign(endless, tmp_path / name, workers=0, scheduler=address, hooks=hooks)
            assert 0 < ended.done < ended.total
            return ended.end_reason

        assert "no worker is left" in end_after_a_row("no worker", one, two)
        with started(*worker):
            wait_for_workers(1)
            assert "the scheduler is gone" in end_after_a_row("no scheduler", post)


def test_whatever_a_run_does_is_a_row(tmp_path: Path) -> None:
    """A law that gives up, one with a bug and one that kills its worker cost one row each, with the reason."""
    text = LAWS.replace(
        "{LAWS}",
        "gives up: tests.support.laws:GivesUp, buggy: tests.support.laws:Buggy, deadly: tests.support.laws:Deadly",
    )
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}):
        result = fly(tmp_path, "bad", text, workers=1)
    assert (result.end_reason, result.passed) == ("completed", False)
    fine, gives_up, buggy, deadly = rows(tmp_path / "bad")
    assert fine["passed"]
    assert not any(row["passed"] or row["completed"] for row in (gives_up, buggy, deadly))
    assert gives_up["end_reason"] == "controller: gives_up: patience: enough at t = 0.5 s"
    assert gives_up["ticks"] == 2
    assert gives_up["base/roll.max_error"] is not None
    assert buggy["end_reason"] == "bug: KeyError: 'a typo'"
    assert deadly["end_reason"] == "lost: KilledWorker"
    assert sorted(path.name for path in (tmp_path / "bad" / "runs").iterdir()) == ["000001", "000002"]
    journal = [json.loads(line) for line in (tmp_path / "bad" / "rows.jsonl").read_text().splitlines()[1:]]
    assert "KeyError" in next(row["trace"] for row in journal if row["index"] == 2)
    assert [row["index"] for row in journal if row["lost"]] == [3]
