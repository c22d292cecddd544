"""A run as a moving picture."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import space_robot as sr
from tests.support.robots import random_model, robot_of
from tests.support.tool import Tool, refused

pytest.importorskip("matplotlib")
Image = pytest.importorskip("PIL.Image")
from space_robot_report.figures import video  # noqa: E402


@pytest.fixture(scope="module")
def run() -> sr.Run:
    """A run in which something moves."""
    return sr.run("liu2023/fig08", {"duration": 8.0})


def test_the_film_shows_the_robot_move(run: sr.Run, tmp_path: Path) -> None:
    """As many frames as asked for, each with something in it, and not all the same."""
    assert video.film(run.directory, tmp_path / "run.gif", seconds=1.0, fps=4) == 4
    frames = []
    with Image.open(tmp_path / "run.gif") as picture:
        for index in range(picture.n_frames):
            picture.seek(index)
            frames.append(np.asarray(picture.convert("L"), dtype=float))
    assert len(frames) == 4
    assert all(frame.std() > 5.0 for frame in frames)
    assert np.abs(frames[0] - frames[-1]).max() > 50.0


def test_the_lines_are_the_links_of_the_robot() -> None:
    """A branching robot has no line from the end of one branch to the beginning of the next; a box has twelve edges."""
    model = random_model(np.random.default_rng(3), 9)
    parents = list(model.parents)
    assert len(set(parents[2:])) < len(parents[2:]), "a tree that branches is wanted"
    order = video._outward_and_back(robot_of(model))
    drawn = {frozenset(pair) for pair in pairwise(order) if pair[0] != pair[1]}
    assert drawn == {frozenset((joint - 1, parents[joint] - 1)) for joint in range(2, len(parents))}
    edges = {frozenset((tuple(a), tuple(b))) for a, b in pairwise(video.CUBE.tolist())}
    assert len(edges) == 12
    assert all(sum(x != y for x, y in zip(*edge, strict=True)) == 1 for edge in edges)


def test_the_command_writes_beside_the_log(run: sr.Run, tmp_path: Path, space_robot: Tool) -> None:
    """A GIF where nothing else is said; what cannot be is one line."""
    (tmp_path / "bag").symlink_to(run.directory)
    assert "bag.gif (2 frames)" in space_robot("video", "bag", "--seconds", "0.5", "--fps", "4").stdout
    assert (tmp_path / "bag.gif").is_file()
    refused(space_robot("video", "bag", "--out", "run.avi"), "--out", "run.avi", ".gif")
    refused(space_robot("video", "bag", "--fps", "0"), "--fps", "1 to 60")
    refused(space_robot("video", "bag", "--seconds", "nan"), "--seconds")


def test_without_ffmpeg_a_gif_is_offered(run: sr.Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MP4 needs a program that may not be there."""
    monkeypatch.setattr(video.FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    with pytest.raises(sr.SpaceRobotError, match=r"needs ffmpeg.*accepted: FILE\.gif"):
        video.film(run.directory, tmp_path / "run.mp4")
