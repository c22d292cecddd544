"""A library of the system that an installed package needs and does not bring: said in one line."""

from __future__ import annotations

# Wheels leave these to the system; a container of the least kind has none of them.
DEBIAN = {"libgomp.so.1": "libgomp1"}


def missing_library(error: ImportError) -> str | None:
    """What is missing and how it is installed, None where the error is about something else.

    Args:
        error: of an import; the words are those of the dynamic loader.
    """
    name, separator, _ = str(error).partition(": cannot open shared object file")
    if not separator:
        return None
    advice = f" (Debian, Ubuntu: apt install {DEBIAN[name]})" if name in DEBIAN else ""
    return f"an installed package needs {name}, a library of the system that is not installed{advice}"
