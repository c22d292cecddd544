"""The kinds of files that are checked, and how one knows them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from space_robot_description.share import is_file, shipped
from space_robot_description.yaml_files import parse_yaml

FOLDERS = {"experiment": "experiments", "campaign": "campaigns", "paper": "papers"}


def kind_of(name_or_path: str) -> str:
    """``experiment``, ``campaign`` or ``paper``: by the keys of a file, by the folder of a shipped name.

    A name that is shipped as an experiment and as a campaign is the experiment.
    """
    if is_file(path := Path(name_or_path)):
        data: Any = parse_yaml(path)
        return "paper" if "figures" in data else "campaign" if "experiment" in data else "experiment"
    return next((kind for kind, folder in FOLDERS.items() if name_or_path in shipped(folder)), "experiment")
