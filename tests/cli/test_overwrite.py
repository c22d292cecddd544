"""`space-robot run` beside runs that are there already."""

from __future__ import annotations

from pathlib import Path

from tests.support.tool import Tool

SHORT = ("run", "liu2023/fig08", "--duration", "1.0", "--set", "expect={}")


def bytes_of(directory: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in directory.iterdir()}


def test_a_run_without_a_directory_never_meets_another(space_robot: Tool, tmp_path: Path) -> None:
    """It is called as its experiment, with the folder of a shipped one, and gets a number where one is there."""
    space_robot(*SHORT)
    first = bytes_of(tmp_path / "runs" / "liu2023" / "fig08")
    said = space_robot(*SHORT, "--set", "seed=5").stdout
    assert "runs/liu2023/fig08_2" in said
    assert bytes_of(tmp_path / "runs" / "liu2023" / "fig08") == first
    assert bytes_of(tmp_path / "runs" / "liu2023" / "fig08_2")


def test_a_directory_with_a_run_in_it_is_refused(space_robot: Tool, tmp_path: Path) -> None:
    """Exit code 2, nothing run, nothing lost; with --overwrite it is replaced."""
    space_robot(*SHORT, "--out", "here")
    before = bytes_of(tmp_path / "here")
    refused = space_robot(*SHORT, "--out", "here", "--set", "seed=5")
    assert refused.returncode == 2
    for part in ("--out: holds a run already", "here", "--overwrite"):
        assert part in refused.stderr
    assert bytes_of(tmp_path / "here") == before
    space_robot(*SHORT, "--out", "here", "--set", "seed=5", "--overwrite")
    assert bytes_of(tmp_path / "here").keys() == before.keys()
    assert bytes_of(tmp_path / "here") != before
