"""Serves a run to browsers until told to stop."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from time import perf_counter, sleep

import viser

from space_robot_bringup.playback import Footage
from space_robot_bringup.view.clock import PlayClock
from space_robot_bringup.view.motion import Motion
from space_robot_bringup.view.panel import Panel
from space_robot_bringup.view.stage import Stage
from space_robot_description.visual import Look

FRAME_SECONDS = 1.0 / 30.0


@dataclass(frozen=True, eq=False, slots=True)
class Show:
    """What is shown.

    Attributes:
        look: the robot.
        film: its log.
        tool: the link whose way is drawn.
        title: of the run.
        about: a line or two on it, as HTML.
    """

    look: Look
    film: Footage
    tool: str
    title: str
    about: str


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
        on_ready: told the address once it is served.
        stop: asked 30 times a second; a reason ends it.
    """
    with _served(port) as server:
        address = f"http://localhost:{server.get_port()}"
        start, end = float(show.film.time[0]), float(show.film.time[-1])
        clock, motion = PlayClock(start, end), Motion(show.look.model, show.film)
        stage = Stage(server, show.look, motion, show.tool)
        panel = Panel(
            server, clock, start=start, end=end, title=show.title, about=show.about, switches=stage.switches()
        )
        stage.show(motion.at(start))
        on_ready(address)
        if open_browser:
            webbrowser.open(address)
        _play(clock, motion, stage, panel, stop)


@contextmanager
def _served(port: int) -> Iterator[viser.ViserServer]:
    """A server that says nothing by itself: its ``verbose`` leaves a banner and a farewell on stdout."""
    with redirect_stdout(StringIO()):
        server = viser.ViserServer(host="localhost", port=port, verbose=False)
    try:
        yield server
    finally:
        with redirect_stdout(StringIO()):
            server.stop()


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
