"""What is wanted of a condition over time, in words."""

from __future__ import annotations

from space_robot_bringup.experiment.expectations import Moment, Occurrence, Temporal


def pattern(spec: Temporal) -> str:
    """What is wanted of a condition, in words."""
    lasting = f" for {spec.for_:g} s" if spec.for_ is not None else ""
    after = "" if spec.after is None else f" after {_said(spec.after)}"
    until = "" if spec.until is None else f" until {_said(spec.until)}"
    if spec.within is not None:
        return f"within {spec.within:g} s{after or ' after the start'}{lasting}"
    if spec.counts:
        bounds = (("at least", spec.at_least), ("at most", spec.at_most))
        return " and ".join(f"{word} {how_often(count)}" for word, count in bounds if count is not None) + (
            f"{lasting}{after}{until}"
        )
    if spec.at_end:
        return f"at the end{lasting}"
    word = "always" if isinstance(spec, Occurrence) and spec.always else "never"
    return f"{word}{lasting}{after}{until}"


def unopened(spec: Temporal) -> str:
    """Why a window never began."""
    if isinstance(spec.after, str):
        return f"{spec.after} did not happen"
    return f"the run ended before {spec.after or 0.0:g} s"


def how_often(count: int) -> str:
    """How often."""
    return "once" if count == 1 else f"{count} times"


def _said(moment: Moment) -> str:
    return moment if isinstance(moment, str) else f"{moment:g} s"
