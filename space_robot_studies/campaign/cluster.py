"""The workers: a local cluster, or whoever is connected to a Dask scheduler; the code is the same from here on."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any

import dask
from distributed import Client, LocalCluster, Nanny
from distributed.comm.core import CommClosedError

from space_robot_bringup.compose.composition import versions
from space_robot_bringup.experiment.experiment import experiment_from
from space_robot_bringup.modes.compilation import must_compile
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.campaign.worker import PINNED, warm

PRELOAD = "space_robot_studies.campaign.worker"
CONNECT_SECONDS = 5
GATHER_SECONDS = 15
LOGGERS = ("distributed", "distributed.client", "distributed.nanny", "tornado", "tornado.application", "asyncio")
CONFIG: dict[str, Any] = {
    # There is nothing to see at its web servers.
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    # One case at a time and worker: when one dies, only the case it was flying is suspected of having killed it.
    "distributed.scheduler.worker-saturation": 1.0,
}


@contextmanager
def workers_at(address: str | None, workers: int, first: Mapping[str, Any]) -> Iterator[Client]:
    """A client whose workers are ready to fly: kernel loaded, versions as here.

    Args:
        address: of a scheduler, e.g. ``tcp://10.0.0.1:8786``; None: a local cluster of this process.
        workers: number of local ones, one thread each.
        first: an experiment every worker makes plant and law of, so that their kernels are loaded.

    Raises:
        SpecError: nobody answers at the address, or its workers could not give the same bits.
    """
    _quiet()
    if address is None and must_compile(experiment_from(first, "first case").controller.law_names):
        # Once and here, not by every worker at the same time.
        warm(first)
    with _local(workers) if address is None else _remote(address) as client:
        _prepare(client, first)
        yield client


@contextmanager
def _local(workers: int) -> Iterator[Client]:
    with (
        dask.config.set(CONFIG),
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            scheduler_kwargs={"dashboard": False},
            worker_class=Nanny,
            memory_limit=0,
            env=PINNED,
            preload=PRELOAD,
            silence_logs=logging.CRITICAL,
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client


@contextmanager
def _remote(address: str) -> Iterator[Client]:
    key, accepted = "--scheduler", "the address of a running Dask scheduler, e.g. tcp://10.0.0.1:8786"
    try:
        client = Client(address, timeout=CONNECT_SECONDS)
    except (OSError, ValueError, TypeError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise SpecError(f"cannot be reached ({reason})", key=key, value=address, accepted=accepted) from None
    try:
        try:
            client.wait_for_workers(1, timeout=GATHER_SECONDS)
        except TimeoutError:
            raise SpecError("has no workers", key=key, value=address, accepted="dask worker ADDRESS") from None
        yield client
    finally:
        with suppress(CommClosedError, OSError, TimeoutError):
            client.close()


def _prepare(client: Client, first: Mapping[str, Any]) -> None:
    """Load the kernel everywhere and refuse workers whose bits could differ."""
    here = versions()
    for worker, count in client.nthreads().items():
        if count != 1:
            accepted = "dask worker ADDRESS --nthreads 1, as often as there are cores"
            raise SpecError("a worker has several threads", key=worker, value=count, accepted=accepted)
    try:
        found: dict[str, dict[str, str]] = client.run(warm, first)
    except Exception as error:
        # Whatever a worker without our packages makes of the request.
        what = f"cannot fly this ({type(error).__name__}: {error})"
        raise SpecError(what, key="workers", accepted="some with the same space-robot installed") from None
    for worker, there in found.items():
        different = [f"{name} {there.get(name)}" for name in here if there.get(name) != here[name]]
        if different:
            wanted = ", ".join(f"{name} {here[name]}" for name in here)
            raise SpecError("a worker has other versions", key=worker, value=", ".join(different), accepted=wanted)


def _quiet() -> None:
    """Its own remarks on dying workers and closed connections say nothing that we do not say ourselves."""
    for name in LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL)
