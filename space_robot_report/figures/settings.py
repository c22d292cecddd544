"""Figures with matplotlib's own settings, wherever the program is started.

matplotlib reads ``matplotlibrc`` in the working directory, where a file that came with a log may lie: such a file can
name functions to be called for each figure, and programs to set text with.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl


@contextmanager
def own_settings(look: Mapping[str, Any] | None = None) -> Iterator[None]:
    """Draw with matplotlib's own settings and some of the project; afterwards those of before are back.

    Args:
        look: settings of the project.
    """
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(look or {})
        yield
