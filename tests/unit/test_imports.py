"""The root listing is the architecture: who may import whom, and where ROS may be known."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FACE = "space_robot"
MSGS, DESCRIPTION, CONTROL, SIM, BRINGUP = (
    f"{FACE}_{name}" for name in ("msgs_py", "description", "control", "sim", "bringup")
)
MAY_IMPORT = {
    MSGS: {MSGS},
    DESCRIPTION: {DESCRIPTION, MSGS},
    CONTROL: {CONTROL, DESCRIPTION, MSGS},
    SIM: {SIM, DESCRIPTION, MSGS},
    BRINGUP: {BRINGUP, SIM, CONTROL, DESCRIPTION, MSGS},
    FACE: {BRINGUP, SIM, CONTROL, DESCRIPTION, MSGS},
}
ROS = ("rclpy", "domain_coordinator", "std_msgs", "std_srvs", "sensor_msgs", "nav_msgs", "geometry_msgs")
ROS += ("trajectory_msgs", "diagnostic_msgs", "rosgraph_msgs", "builtin_interfaces", "rcl_interfaces")
PLOTTING = ("matplotlib", "plotly", "viser")


def imports(path: Path) -> list[tuple[int, str]]:
    """(line, top-level package) of every absolute import in a file."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name.split(".")[0]) for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.append((node.lineno, node.module.split(".")[0]))
    return found


def ros_is_allowed(path: Path) -> bool:
    relative = path.relative_to(ROOT)
    return (
        "nodes" in relative.parts
        or relative.as_posix() == f"{MSGS}/ros.py"
        or relative.as_posix() == f"{BRINGUP}/graph.py"
    )


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_packages_import_only_what_the_architecture_allows(package: str) -> None:
    """No file imports a package that stands above its own, nor ROS outside nodes/, ros.py and graph.py."""
    files = sorted((ROOT / package).rglob("*.py"))
    assert files, f"{package} has no files"
    wrong = []
    for path in files:
        for line, name in imports(path):
            if name.startswith(FACE) and name not in MAY_IMPORT[package]:
                wrong.append(f"{path.name}:{line} imports {name}")
            if name in ROS and not ros_is_allowed(path):
                wrong.append(f"{path.name}:{line} imports {name}")
            if name in PLOTTING and not {"report", "view"} & set(path.relative_to(ROOT).with_suffix("").parts):
                wrong.append(f"{path.name}:{line} imports {name}")
    assert wrong == []


def test_everything_but_the_nodes_imports_without_ros() -> None:
    """On a machine without ROS every module outside nodes/, ros.py, graph.py (and what runs them) can be imported."""
    needs_ros = {f"{BRINGUP}.processes"}
    modules = [
        ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for package in MAY_IMPORT
        for path in sorted((ROOT / package).rglob("*.py"))
        if not ros_is_allowed(path) and path.name != "__init__.py"
    ]
    block = f"import sys, importlib\nfor name in {ROS!r}: sys.modules[name] = None\n"
    load = f"for name in {[m for m in modules if m not in needs_ros]!r}: importlib.import_module(name)\n"
    done = subprocess.run([sys.executable, "-c", block + load], capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
