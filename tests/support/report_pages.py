"""Pages of runs, and what is on them."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path

import numpy as np

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment


def recorded(directory: Path, name: str = "liu2023/fig08", *overrides: str) -> Path:
    """Run a shipped experiment into a run directory."""
    run_experiment(load_experiment(name, overrides), directory, mode="headless")
    return directory


def data_of(page: str, name: str) -> object:
    """What the page's scripts read."""
    found = re.search(rf'<script type="application/json" id="{name}">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    return json.loads(found.group(1))


def unpacked(array: dict[str, str]) -> np.ndarray:
    """The numbers of a plot's array."""
    return np.frombuffer(base64.b64decode(array["bdata"]), dtype=f"<{array['dtype']}")


def own_markup(page: str) -> str:
    """The page without its scripts: plotly.js mentions many an address, none of which it asks for by itself."""
    return re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
