"""The controls in the browser: time, play and pause, speed, and what is shown."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import viser

from space_robot_report.viewer import story
from space_robot_report.viewer.clock import PlayClock
from space_robot_report.viewer.show import Show

SPEEDS = ("0.25", "0.5", "1", "2", "5", "10", "50")
STEPS = 1000
STYLE = "padding: 0 0.9em; font-size: 0.875rem; line-height: 1.5; overflow-wrap: anywhere"


class Panel:
    """Controls that steer a clock and follow it.

    Args:
        server: of viser.
        clock: of the playback.
        show: its texts are HTML: what a log says in them is escaped, see ``escapes.html``.
        start: of the run [s].
        end: of the run [s].
        switches: label to the callback of its switch.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        clock: PlayClock,
        show: Show,
        *,
        start: float,
        end: float,
        switches: Mapping[str, Callable[[bool], None]],
    ) -> None:
        self._clock, self._spans = clock, show.spans
        gui = server.gui
        head(gui, show.title, show.about)
        self._now = ""
        if story.now(show.spans, start):
            gui.add_html(framed(story.bands(show.spans, start, end)))
            self._shown_now = gui.add_html("")
        self._button = gui.add_button("Play")
        span = max(end - start, 1e-3)
        self._slider = gui.add_slider("time [s]", start, start + span, max(span / STEPS, 1e-3), start)
        self._speed = gui.add_dropdown("speed", SPEEDS, initial_value="1")
        self._button.on_click(lambda _: clock.toggle())
        self._slider.on_update(self._on_slider)
        self._speed.on_update(self._on_speed)
        for label, tell in switches.items():
            add_switch(gui, label, tell)
        if show.events:
            with gui.add_folder("events", expand_by_default=False):
                gui.add_html(framed(story.table(show.events)))
        self.follow()

    def follow(self) -> None:
        """Show where the clock is."""
        self._slider.value = self._clock.now
        label = "Pause" if self._clock.playing else "Play"
        if self._button.label != label:
            self._button.label = label
        if (now := story.now(self._spans, self._clock.now)) != self._now:
            self._now, self._shown_now.content = now, framed(now)

    def _on_slider(self, event: Any) -> None:
        # Its own ``follow`` moves the slider too; only a person has a client.
        if event.client is not None:
            self._clock.seek(float(self._slider.value))

    def _on_speed(self, event: Any) -> None:
        del event
        self._clock.speed = float(self._speed.value)


def head(gui: Any, title: str, about: str) -> None:
    """Title of the panel, and a line or two of HTML."""
    gui.configure_theme(show_logo=False, show_share_button=False, control_width="medium")
    gui.set_panel_label(title)
    # Not Markdown: viser takes HTML in it for what it is, and reads the files its images name.
    gui.add_html(framed(about))


def add_switch(gui: Any, label: str, tell: Callable[[bool], None]) -> None:
    """A switch that is on, and tells when it is turned."""
    switch = gui.add_checkbox(label, initial_value=True)

    def on_update(event: Any) -> None:
        del event
        tell(switch.value)

    switch.on_update(on_update)


def framed(content: str) -> str:
    """HTML as it stands in the panel."""
    return f'<div style="{STYLE}">{content}</div>'
