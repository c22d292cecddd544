"""What stands beside the robot while a run goes on: time, mode, switches, and what happened."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping

import viser

from space_robot_bringup.logs.happened import Happened
from space_robot_msgs_py.escapes import html, visible
from space_robot_report.live.brief import Brief
from space_robot_report.viewer import story
from space_robot_report.viewer.panel import add_switch, framed, head

# Of what happened; the newest stand first.
MAX_SHOWN = 100


class LivePanel:
    """The panel of a run that goes on; every text of the run is text, whatever it looks like.

    Args:
        server: of viser.
        brief: of the run.
    """

    def __init__(self, server: viser.ViserServer, brief: Brief) -> None:
        self._gui = server.gui
        head(self._gui, visible(brief.title), f"<p>{html(brief.about)}</p><p>It goes on while you look.</p>")
        self._now = self._gui.add_html(framed("<p>waits for the first state</p>"))
        self._events: deque[Happened] = deque(maxlen=MAX_SHOWN)
        self._table: viser.GuiHtmlHandle | None = None
        self._changed = False

    def add_switches(self, switches: Mapping[str, Callable[[bool], None]]) -> None:
        """Switches for what is in the scene, once it is there."""
        for label, tell in switches.items():
            add_switch(self._gui, label, tell)

    def note(self, events: Iterable[Happened]) -> None:
        """Something happened."""
        found = list(events)
        self._events.extendleft(found)
        self._changed = self._changed or bool(found)

    def follow(self, time: float, mode: str) -> None:
        """Show the time of the run [s], the mode of its supervisor, if it has one, and what happened since."""
        said = f"<p>time {time:.2f} s</p>" + (f"<p><b>{html(mode)}</b></p>" if mode else "")
        self._now.content = framed(said)
        if not self._changed:
            return
        self._changed = False
        if self._table is None:
            with self._gui.add_folder("events"):
                self._table = self._gui.add_html("")
        self._table.content = framed(story.table(tuple(self._events)))
