"""What happened in a run as HTML for the panel: modes and faults as bands, events as a table, and what is on now."""

from __future__ import annotations

from collections.abc import Sequence

from space_robot_bringup.logs.happened import Happened
from space_robot_bringup.logs.spans import Span, Spans
from space_robot_msgs_py.escapes import html
from space_robot_report.palette import FAULT, mode_colors

# Of events in the table: the panel is narrow, and every line goes to every browser.
MAX_LISTED = 200
CELL = "padding: 0.1em 0.4em 0.1em 0; text-align: left; vertical-align: top"


def bands(spans: Spans, start: float, end: float) -> str:
    """A strip of the modes, and one of each fault below it, over the time of the run [s]."""
    colors = mode_colors(span.name for span in spans.modes)
    strips = [_strip([(span, colors[span.name]) for span in spans.modes], start, end)] if spans.modes else []
    strips += [_strip([(span, FAULT)], start, end) for span in spans.faults]
    keys = [_key(color, name) for name, color in colors.items()] + [_key(FAULT, span.said) for span in spans.faults]
    return f"{''.join(strips)}<p>{' '.join(keys)}</p>" if strips else ""


def now(spans: Spans, time: float) -> str:
    """The mode and the faults at a time [s] of the run."""
    mode, faults = spans.at(time)
    said = [f"<b>{html(mode)}</b>"] if mode else []
    said += [f"fault: {html(name)}" for name in faults]
    return f"<p>{', '.join(said) or 'no fault'}</p>" if spans.modes or spans.faults else ""


def table(events: Sequence[Happened]) -> str:
    """The events, gravest in bold."""
    rows = [_row(event) for event in events[:MAX_LISTED]]
    more = f"<p>and {len(events) - MAX_LISTED} more</p>" if len(events) > MAX_LISTED else ""
    return f'<table style="font-size: 0.75rem">{"".join(rows)}</table>{more}'


def _row(event: Happened) -> str:
    what = html(f"{event.name} {event.message}".strip())
    what = f"<b>{what}</b>" if event.severity == "high" else what
    texts = (f"{event.time:g} s", html(event.severity), what)
    cells = "".join(f'<td style="{CELL}">{text}</td>' for text in texts)
    return f"<tr>{cells}</tr>"


def _strip(spans: Sequence[tuple[Span, str]], start: float, end: float) -> str:
    whole = max(end - start, 1e-9)
    parts = [
        f'<span title="{html(span.said)}" style="position: absolute; top: 0; bottom: 0; background: {color}; '
        f"left: {100 * (span.begin - start) / whole:.3f}%; width: {100 * (span.end - span.begin) / whole:.3f}%"
        '"></span>'
        for span, color in spans
    ]
    return f'<div style="position: relative; height: 0.6em; margin: 0.15em 0">{"".join(parts)}</div>'


def _key(color: str, text: str) -> str:
    square = f'<span style="display: inline-block; width: 0.7em; height: 0.7em; background: {color}"></span>'
    return f"{square} {html(text)}"
