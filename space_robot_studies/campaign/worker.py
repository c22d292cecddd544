"""What a worker process is before its first run; Dask loads this module into it (``--preload``)."""

from __future__ import annotations

import signal
from collections.abc import Mapping
from typing import Any

from space_robot_bringup.compose.composition import compose, versions
from space_robot_bringup.experiment.experiment import experiment_from
from space_robot_studies.garbage_collection import collect_rarely

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
    collect_rarely()


def warm(data: Mapping[str, Any]) -> dict[str, str]:
    """Load what is compiled by making plant and law; tell the versions of everything that can change a run's bits."""
    composition = compose(experiment_from(data, "first case"))
    composition.plant().reset()
    composition.controller().reset()
    return versions()
