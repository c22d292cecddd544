"""What a worker process is before its first run; Dask loads this module into it (``--preload``)."""

from __future__ import annotations

import signal
from collections.abc import Mapping
from typing import Any

from space_robot_bringup.compose import compose, versions
from space_robot_bringup.experiment import experiment_from

# Matrices here are small: more threads only fight for the cores that fly other runs.
PINNED = {
    name: "1"
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "BLIS_NUM_THREADS")
}


def dask_setup(worker: Any) -> None:
    """Called by Dask in the main thread of a new worker process.

    Ctrl-C in a terminal reaches every process of it; the campaign alone decides what follows.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def warm(data: Mapping[str, Any]) -> dict[str, str]:
    """Load the compiled plant by making one; tell the versions of everything that can change the bits of a run."""
    compose(experiment_from(data, "first case")).plant().reset()
    return versions()
