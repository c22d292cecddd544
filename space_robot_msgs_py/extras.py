"""How what is missing is installed: this project may be on no index, only where it was installed from."""

from __future__ import annotations

import json
from urllib.parse import unquote, urlsplit

PROJECT = "space-robot"


def install(extra: str) -> str:
    """The advice to install an extra, with the command for this installation.

    Args:
        extra: of the project, as in ``space-robot[viz]``.
    """
    return f"install {PROJECT}[{extra}]: pip install {_source(extra)}"


def _source(extra: str) -> str:
    # Here, because it loads a reader of e-mail, and only who lacks something asks.
    from importlib.metadata import PackageNotFoundError, distribution

    try:
        # PEP 610: there where it did not come from an index.
        origin = json.loads(distribution(PROJECT).read_text("direct_url.json") or "{}")
    except (PackageNotFoundError, ValueError):
        origin = {}
    address = urlsplit(str(origin.get("url", "")))
    if address.scheme != "file":
        return f"'{PROJECT}[{extra}]'"
    editable = origin.get("dir_info", {}).get("editable", False)
    return f"{'-e ' * bool(editable)}'{unquote(address.path)}[{extra}]'"
