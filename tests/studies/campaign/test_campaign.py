"""Campaigns give the same table whatever runs them and whatever dies meanwhile; every case can be run again."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

pq = pytest.importorskip("pyarrow.parquet")
pytest.importorskip("scipy")

from space_robot_cli.main import main  # noqa: E402
from space_robot_studies.campaign.campaign import run_campaign  # noqa: E402
from space_robot_studies.campaign.spec import load_campaign  # noqa: E402
from space_robot_studies.engine.hooks import StudyHooks  # noqa: E402
from tests.support.campaigns import (  # noqa: E402
    CAMPAIGN,
    REASONS,
    finished,
    reasons,
    results,
    rows,
    run_in,
    started,
    wait_for,
    without,
    write,
)
from tests.support.follow import DEADLINE, ended  # noqa: E402
from tests.support.forks import fork_main  # noqa: E402
from tests.support.nonempty import nonempty  # noqa: E402
from tests.support.processes import descendants  # noqa: E402

pytestmark = pytest.mark.xdist_group("campaign")


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
    command = ["campaign", str(tmp_path / "test.yaml"), "--out", str(out), "--workers", "2"]
    with ended([fork_main("space_robot_cli.main", *command)]) as (campaign,):
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
    command = ["campaign", str(tmp_path / "test.yaml"), "--out", str(out), "--workers", "1"]
    with ended([fork_main("space_robot_cli.main", *command, session=True)]) as (campaign,):
        wait_for(lambda: finished(out) >= 2, "the first rows")
        processes = descendants(campaign.pid)
        os.killpg(campaign.pid, number)
        said = "".join(campaign.communicate(DEADLINE))
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
