"""What a long log takes of memory and CPU time to be judged, looked at and drawn: each in a process of its own."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from tests.support.long_logs import write_long_log

# 10,000 s at 0.1 s, and a quarter of it.
TICKS = 100_001
FEW = TICKS // 4
JUDGE = """
from space_robot_bringup.judge.judging import judge_blocks
from space_robot_bringup.logs.logged import compose_logged, logged_experiment
from space_robot_msgs_py.log.reader import LogReader
reader = LogReader(sys.argv[1])
composition = compose_logged(logged_experiment(reader.header.experiment))
base = peak()
metrics, *_ = judge_blocks(reader.event_blocks(), composition, "completed")
assert metrics.ticks == int(sys.argv[2])
"""
INFO = """
from space_robot_bringup.logs import info
base = peak()
info.LARGE = 0
info.bag_info(Path(sys.argv[1]))
"""
PAGE = """
from space_robot_report.pages.log_report import write_log_report
base = peak()
write_log_report(Path(sys.argv[1]), Path(sys.argv[1]).with_suffix(".html"))
"""
FRAME = """
import resource, sys
from pathlib import Path
def peak():
    # Not of getrusage, which also counts what the parent had when this process was made.
    (kib,) = (line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM"))
    return int(kib) * 1024 / 1e6
{what}
used = resource.getrusage(resource.RUSAGE_SELF)
print(base, peak(), used.ru_utime + used.ru_stime)
"""


def run() -> dict[str, float]:
    """Megabytes and seconds for a log of 10,000 s at 0.1 s, and what a tick more takes."""
    rows: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as scratch:
        few, many = Path(scratch) / "few", Path(scratch) / "many"
        write_long_log(few, FEW)
        write_long_log(many, TICKS)
        rows[f"log of {TICKS} ticks, MB"] = sum(file.stat().st_size for file in many.iterdir()) / 1e6
        for name, what in (("judge", JUDGE), ("info, by the index", INFO), ("report", PAGE)):
            _, small, _ = _alone(what, few, FEW)
            base, large, seconds = _alone(what, many, TICKS)
            rows[f"{name}: peak, MB"] = large
            rows[f"{name}: of that the imports, MB"] = base
            rows[f"{name}: a tick more, bytes"] = 1e6 * (large - small) / (TICKS - FEW)
            rows[f"{name}: CPU time, imports included, s"] = seconds
    return rows


def _alone(what: str, log: Path, ticks: int) -> tuple[float, float, float]:
    """Peak after the imports and at the end [MB], CPU time [s]."""
    words = [sys.executable, "-c", FRAME.format(what=what), str(log), str(ticks)]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    base, peak, seconds = map(float, done.stdout.split())
    return base, peak, seconds
