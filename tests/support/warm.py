"""What a fresh clone compiles, compiled before the tests: test modules, and kernels by two processes at a time.

Left to the tests, every worker compiles all test modules for itself, and all workers wait while one compiles a kernel.
Run as ``python -m tests.support.warm``. What fails here fails in the tests, which say why.
"""

from __future__ import annotations

import subprocess
import sys
from multiprocessing import get_context

from space_robot_bringup.fused.run import compiled_run
from space_robot_description.kernel import jit
from space_robot_description.kernel.lanes import LANES
from tests.support.compiled_runs import LAWS, case, looped


def modules() -> None:
    """Test modules with their assertions rewritten, and all that they import."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "-qq", "-p", "no:cacheprovider"]
    subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)


def laws() -> None:
    """Kernels of every law, then those that a run of it calls from Python and those of its compiled run."""
    compositions = [case(law) for law in range(len(LAWS))]
    for composition in compositions:
        looped(composition)
        compiled_run(composition)


def plant() -> None:
    """Kernels of the plant, meanwhile, and those of runs side by side."""
    from space_robot_bringup.fused.lanes import compiled_runs

    case(0).plant()
    compiled_runs([case(k * len(LAWS)) for k in range(2 * LANES + 1)])


def main() -> None:
    """All of it at once."""
    start = get_context("spawn").Process
    jobs = [modules, *([laws, plant] if jit.MACHINE_CODE else [])]
    processes = [start(target=job) for job in jobs]
    for process in processes:
        process.start()
    for process in processes:
        process.join()


if __name__ == "__main__":
    main()
