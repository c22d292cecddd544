"""docs/parameters.md says what nodes declare, no more and no less."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy")

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.modes.context import private_context
from space_robot_bringup.modes.graph import LIGHT, make_node
from space_robot_bringup.nodes.arguments import Start
from space_robot_bringup.nodes.docs import TABLE, documented, parameters_page
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.managed import bring_up
from space_robot_sim.nodes.recorder import RecorderNode
from space_robot_sim.nodes.services import STEP_COUNT
from tests.support.paths import ROOT

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
PAGE = (ROOT / "docs" / "parameters.md").read_text(encoding="utf-8")
# Given by the process that a node runs in.
STARTED_WITH = set(Start.model_fields) - {STEP_COUNT}
OF_ROS = {"use_sim_time", "start_type_description_service"}


def named(heading: str) -> dict[str, bool]:
    """Parameters of a section of the page, and whether they may change."""
    section = PAGE.partition(f"# {heading}\n")[2].partition("\n#")[0]
    rows = re.findall(r"^\| `(.+?)` \|(?:.*?)\|(?:.*?)\| (may change)? ?\|", section, re.MULTILINE)
    return {name: bool(may) for name, may in rows}


def declared(node: GraphNode) -> dict[str, bool]:
    """What ROS shows of a node."""
    names = node.get_parameters_by_prefix("").keys() - OF_ROS
    return {name: not node.describe_parameter(name).read_only for name in names}


def test_the_page_is_up_to_date() -> None:
    """It is what ``python -m space_robot_bringup.nodes.docs`` prints."""
    assert parameters_page() == PAGE


@pytest.mark.parametrize("role", ["recorder", "guidance", "controller", "simulator", "supervisor"])
def test_a_node_has_what_the_page_says(role: str, tmp_path: Path) -> None:
    """Every parameter that it declares, and whether it may change during the run."""
    composition = documented()
    if role == "controller":
        composition = compose(composition.experiment.model_copy(update={"supervision": None}))
    with private_context() as context:
        options: dict[str, Any] = {"context": context, **LIGHT}
        node = make_node(role, composition, tmp_path / "run", realtime=1.0, mode="processes", **options)
        bring_up([node])
        found = declared(node)
        if isinstance(node, RecorderNode):
            node.finish("test over")
        node.destroy_node()
    expected = {name: may for name, may in named("Every node").items() if name not in STARTED_WITH}
    expected |= named(f"`{role}`")
    if role == "controller":
        expected |= named("Gains of `adaptive`")
        del expected["active_law"]
    assert found == expected


def test_the_page_names_every_law_and_the_table() -> None:
    """Their gains are found by people who search for them."""
    assert TABLE in PAGE
    assert named("Gains of `mfac`")["gains.rho"]
    assert not named("Gains of `mfac`")["gains.form"]
    assert named("Every node").keys() >= STARTED_WITH
