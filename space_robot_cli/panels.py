"""The help of the tool: commands by what one does with them, the one to begin with first."""

from __future__ import annotations

from typing import Any

from typer.core import TyperGroup

PANELS = {
    "Run": ("run", "campaign", "compare", "tune", "benchmark", "reproduce"),
    "Look": ("report", "view", "plot", "info", "events", "export", "video"),
    "Verify": ("check", "replay", "recover"),
    "Prepare": ("new", "list", "robot", "schema"),
}
OTHERS = "Others"


class PanelGroup(TyperGroup):
    """Commands in the order of ``PANELS``."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Names in the order of the panels, then what is in none."""
        known = [name for names in PANELS.values() for name in names if name in self.commands]
        return [*known, *sorted(set(self.commands) - set(known))]

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """A section for each panel; one width for all names."""
        width = max(map(len, self.commands))
        names, listed = dict(PANELS), {name for names in PANELS.values() for name in names}
        names[OTHERS] = tuple(name for name in self.list_commands(ctx) if name not in listed)
        for panel, members in names.items():
            rows = [
                (name.ljust(width), self.commands[name].get_short_help_str(formatter.width - width - 6))
                for name in members
                if name in self.commands
            ]
            if rows:
                with formatter.section(panel):
                    formatter.write_dl(rows)
