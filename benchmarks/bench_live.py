"""Paced runs in one process, shown and not shown: what a viewer and a client of Foxglove cost them."""

from __future__ import annotations

import json
import tempfile
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from threading import Thread
from time import process_time

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.context import private_context
from space_robot_bringup.modes.graph import make_graph, spin_graph
from space_robot_bringup.modes.hooks import Hooks
from space_robot_report.live.brief import Brief
from space_robot_report.live.companion import shown_live

CASE = "liu2023/fig08"
PERIODS = 200
# Periods per second: as on a satellite, and as fast as a fast one.
RATES = (4.0, 20.0, 40.0)
REPEATS = 5


def run() -> dict[str, float]:
    """Periods without a command of their own in all runs, of how many, and CPU of the run per period; taking turns."""
    composition = compose(load_experiment(CASE, [f"duration={PERIODS * 0.25}", "expect={}"]))
    table: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as scratch:
        for repeat in range(REPEATS):
            for rate in RATES:
                for shown in (False, True):
                    place = Path(scratch) / f"{shown}_{rate:g}_{repeat}"
                    missed, seconds = _paced(composition, place, rate, shown=shown)
                    row = f"{rate:g} periods/s, {'viewer and Foxglove beside' if shown else 'not shown'}"
                    table[f"{row}: periods missed, of {REPEATS * PERIODS}"] += missed
                    table[f"{row}: CPU of the run per period [ms]"] += 1e3 * seconds / (REPEATS * PERIODS)
    return dict(table)


def _paced(composition: Composition, place: Path, rate: float, *, shown: bool) -> tuple[int, float]:
    with _watched(composition) if shown else nullcontext(), private_context() as context:
        graph = make_graph(composition, place, context=context, realtime=0.25 * rate)
        before = process_time()
        spin_graph(graph, context, Hooks())
        seconds = process_time() - before
        counts = graph.simulator.commands.counts
        for node in graph.nodes:
            node.destroy_node()
    return counts["missed"], seconds


@contextmanager
def _watched(composition: Composition) -> Iterator[None]:
    """A viewer without a browser, and a client of Foxglove that takes everything."""
    header = composition.header
    brief = Brief("benchmark", "", header.joint_names, header.urdf, header.topics, view=8080, foxglove=0)
    with shown_live(brief) as addresses:
        client = Thread(target=_take_all, args=(addresses["foxglove"],))
        client.start()
        yield
    client.join()


def _take_all(address: str) -> None:
    with connect(address, subprotocols=[Subprotocol("foxglove.sdk.v1")], max_size=None) as socket:
        socket.recv()
        channels = json.loads(socket.recv())["channels"]
        wanted = [{"id": one["id"], "channelId": one["id"]} for one in channels]
        socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
        try:
            while True:
                socket.recv()
        except ConnectionClosed:
            return
