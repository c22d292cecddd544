"""The advice to install what is missing works from where the project came from."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from space_robot_msgs_py.extras import install

ORIGINS = {
    "a clone": ({"url": "file:///a%20b/space-robot", "dir_info": {"editable": True}}, "-e '/a b/space-robot[viz]'"),
    "a folder": ({"url": "file:///src/space-robot", "dir_info": {}}, "'/src/space-robot[viz]'"),
    "a wheel": ({"url": "file:///tmp/space_robot-1-py3-none-any.whl"}, "'/tmp/space_robot-1-py3-none-any.whl[viz]'"),
    "an index": (None, "'space-robot[viz]'"),
    "a repository": ({"url": "https://example.org/space-robot.git", "vcs_info": {}}, "'space-robot[viz]'"),
}


@pytest.mark.parametrize("origin", ORIGINS)
def test_the_advice_names_where_the_project_came_from(
    origin: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An editable clone stays one; what came from an index is asked for there."""
    record, source = ORIGINS[origin]
    place = tmp_path / "space_robot-0.0.0.dist-info"
    place.mkdir()
    (place / "METADATA").write_text("Metadata-Version: 2.1\nName: space-robot\nVersion: 0.0.0\n")
    if record is not None:
        (place / "direct_url.json").write_text(json.dumps(record))
    monkeypatch.syspath_prepend(str(tmp_path))
    assert install("viz") == f"install space-robot[viz]: pip install {source}"
