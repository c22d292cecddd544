"""The kill matrix: every process of a run is killed at random instants, in lock-step and paced.

python -m tests.chaos.kill --repeats 10 [--victims recorder parent] [--limit 2.0]

A row is as it should be when the run ends within the limit, nothing of it lives on, the log has the right reason, and
no more of it is lost than docs/log.md says. Exit 1 where one is not.
"""

from __future__ import annotations

import argparse
import os
import random
import sys
import tempfile
from pathlib import Path
from statistics import median

from space_robot_sim.nodes.tick_parts import MAX_LATE
from tests.chaos.victims import VICTIMS, Kill, Remains, kill_one

# Simulated seconds per second of the paced runs: 40 periods a second. Much faster, a busy machine misses so many
# commands that the run fails by itself.
REALTIME, PERIOD = 10.0, 0.25
LOST_IN_LOCK_STEP = 1


def main(arguments: list[str] | None = None) -> int:
    """Run the matrix and print it."""
    parser = argparse.ArgumentParser(prog="python -m tests.chaos.kill", description=__doc__.partition("\n")[0])
    parser.add_argument("--repeats", type=int, default=10, help="kills of each kind")
    parser.add_argument("--victims", nargs="+", choices=VICTIMS, default=VICTIMS)
    parser.add_argument("--paces", nargs="+", choices=("lock-step", "paced"), default=("lock-step", "paced"))
    parser.add_argument("--limit", type=float, default=2.0, help="a run may take so long to end [s]")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(arguments)
    rng, bad = random.Random(options.seed), 0
    print(f"seed {options.seed}, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}")
    print(
        f"{'victim':<12}{'pace':<12}{'kills':>6}{'end [s] median, max':>22}{'order [s] max':>14}{'lost max':>10}  wrong"
    )
    for victim in options.victims:
        for pace in options.paces:
            realtime = REALTIME if pace == "paced" else None
            remains, wrong = [], list[str]()
            for _ in range(options.repeats):
                with tempfile.TemporaryDirectory() as scratch:
                    # Between two reports of progress, so that every instant is as likely as any other.
                    delay = rng.uniform(0.0, 0.3)
                    remains.append(kill_one(Kill(victim, Path(scratch) / "run", delay, realtime)))
                wrong += faults(remains[-1], realtime, options.limit)
            bad += len(wrong)
            print(_row(victim, pace, remains, wrong), flush=True)
    return 1 if bad else 0


def faults(found: Remains, realtime: float | None, limit: float) -> list[str]:
    """What is not as it should be."""
    allowed = LOST_IN_LOCK_STEP
    if realtime is not None:
        # The clock goes on until the simulator is notified, or hears nothing any more itself.
        allowed += int(found.seconds * realtime / PERIOD)
        # Ticks without a command wait in the recorder for one that may still act.
        allowed += MAX_LATE if found.victim == "recorder" else 0
    checks = {
        f"took {found.seconds:.2f} s": found.seconds <= limit,
        f"{found.orphans} orphans": not found.orphans,
        f"the log says {found.reason!r}": found.reason == found.expected,
        f"the run says {found.said!r}": found.said in (None, found.expected),
        f"lost {found.lost} ticks": found.lost <= allowed,
        f"left {found.litter}": not found.litter,
    }
    return [text for text, fine in checks.items() if not fine]


def _row(victim: str, pace: str, remains: list[Remains], wrong: list[str]) -> str:
    ends = [found.seconds for found in remains]
    ordered = [found.decided for found in remains if found.decided is not None]
    said = f"{max(ordered):.3f}" if ordered else "-"
    lost = max(found.lost for found in remains)
    span = f"{median(ends):.2f}, {max(ends):.2f}"
    return f"{victim:<12}{pace:<12}{len(remains):>6}{span:>22}{said:>14}{lost:>10}  {'; '.join(wrong) or 'nothing'}"


if __name__ == "__main__":
    sys.exit(main())
