"""Why a run ended, in the words of a log: what a node says of its part, or what is said of its process."""

from __future__ import annotations


def of_process(role: str, what: str) -> str:
    """The reason where a process ended or was silent, whatever the part in it would have done.

    Args:
        role: of the process.
        what: happened to it: ``ended with signal SIGKILL``.
    """
    return f"{role}: its process {what}"


def is_of_process(reason: str) -> bool:
    """Whether a reason is about a process, so that nothing follows from it for what law or plant compute."""
    return reason.partition(": ")[2].startswith("its process ")
