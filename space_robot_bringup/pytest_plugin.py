"""A plugin of pytest that comes with the installation: runs and graphs as fixtures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from space_robot_bringup.public.open_graph import OpenGraph
    from space_robot_bringup.public.result import Run


@pytest.fixture
def space_robot_run(tmp_path: Path) -> Callable[..., Run]:
    """``space_robot.run`` with its logs in ``tmp_path``: ``space_robot_run("liu2023/fig08", {"duration": 5.0})``."""
    # Only here: every pytest of an environment loads the plugin.
    from space_robot_bringup.public.run import run

    numbers = count()

    def call(experiment: Any, overrides: Any = None, **options: Any) -> Run:
        return run(experiment, overrides, **{"out": tmp_path / f"space_robot_run{next(numbers)}"} | options)

    return call


@pytest.fixture
def space_robot_graph(tmp_path: Path) -> Iterator[Callable[..., OpenGraph]]:
    """A ROS 2 graph in this process, ``space_robot_graph("liu2023/fig08", without=["controller"])``; skips without ROS.

    Nodes and domain are gone at the end of the test.
    """
    pytest.importorskip("rclpy", reason="no ROS 2")
    from space_robot_bringup.public.open_graph import open_graph

    numbers = count()
    with ExitStack() as stack:

        def call(experiment: Any, overrides: Any = None, **options: Any) -> OpenGraph:
            place = tmp_path / f"space_robot_graph{next(numbers)}"
            return stack.enter_context(open_graph(experiment, overrides, **{"out": place} | options))

        yield call
