"""Text of third parties, made plain text for whatever shows it: one function per target.

Titles, names, labels and reasons come out of logs and off topics. Nowhere may they be more than the text they are.
"""

from __future__ import annotations

import html as _html
import re

# C0 and C1 controls but for tab and newline, what turns the direction of writing, separators of lines, invisible tags,
# and halves of characters, which no stream can write.
_UNSEEN = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufff9-\ufffb"
    "\U000e0000-\U000e007f]"
)


def visible(text: str) -> str:
    r"""For a terminal or a plain file: what would steer it is shown as its code, such as ``\x1b``."""
    return _UNSEEN.sub(lambda found: found.group().encode("unicode_escape", "surrogatepass").decode(), text)


def html(text: str) -> str:
    """For HTML, in an element or in a quoted attribute."""
    return _html.escape(visible(text))


def plotly(text: str) -> str:
    """For the names and titles of plotly.js, which reads some HTML in them: links, bold, line breaks."""
    return _html.escape(visible(text), quote=False)


def mathtext(text: str) -> str:
    """For matplotlib, which takes ``$...$`` for a formula and a name with a leading underscore for none."""
    plain = visible(text).replace("$", r"\$")
    return f" {plain}" if plain.startswith("_") else plain
