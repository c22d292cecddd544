"""Serve a run to browsers until it is stopped."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from io import StringIO
from time import perf_counter, sleep

import viser

from space_robot_report.playback import way_of
from space_robot_report.viewer.clock import PlayClock
from space_robot_report.viewer.motion import Motion
from space_robot_report.viewer.panel import Panel
from space_robot_report.viewer.show import Show
from space_robot_report.viewer.stage import Stage

FRAME_SECONDS = 1.0 / 30.0
# Of the way of the tool; more would only burden the browser.
MAX_STEPS = 3000


def serve(
    show: Show,
    *,
    port: int,
    open_browser: bool,
    on_ready: Callable[[str], None],
    stop: Callable[[], str | None],
) -> None:
    """Serve on localhost.

    Args:
        show: what.
        port: where; the next free one if it is taken.
        open_browser: open a tab.
        on_ready: called with the address once it is served.
        stop: asked 30 times a second; a reason ends it.
    """
    with served(port) as server:
        address = address_of(server)
        start, end = float(show.film.time[0]), float(show.film.time[-1])
        clock, motion = PlayClock(start, end), Motion(show.look.model, show.film)
        way = way_of(show.look.model, show.film.q[:: 1 + len(show.film.q) // MAX_STEPS], show.tool)
        stage = Stage(server, show.look, show.film.q[0], way, desired=show.desired)
        panel = Panel(server, clock, show, start=start, end=end, switches=stage.switches())
        stage.show(motion.at(start))
        on_ready(address)
        if open_browser:
            webbrowser.open(address)
        _play(clock, motion, stage, panel, stop)


@contextmanager
def served(port: int) -> Iterator[viser.ViserServer]:
    """A server that says nothing by itself: its ``verbose`` leaves a banner and a farewell on stdout."""
    with redirect_stdout(StringIO()):
        server = viser.ViserServer(host="localhost", port=port, verbose=False)
    try:
        yield server
    finally:
        with redirect_stdout(StringIO()):
            server.stop()


def address_of(server: viser.ViserServer) -> str:
    """Where a browser finds it."""
    return f"http://localhost:{server.get_port()}"


def _play(clock: PlayClock, motion: Motion, stage: Stage, panel: Panel, stop: Callable[[], str | None]) -> None:
    shown, before = clock.now, perf_counter()
    while stop() is None:
        now = perf_counter()
        clock.advance(now - before)
        before = now
        if clock.now != shown:
            shown = clock.now
            stage.show(motion.at(shown))
        panel.follow()
        sleep(FRAME_SECONDS)
