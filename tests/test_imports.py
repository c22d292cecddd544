"""The root listing is the architecture: who may import whom, and where each outside library may be known."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.paths import ROOT

FACE = "space_robot"
MSGS, DESCRIPTION, CONTROL, SIM, SUPERVISOR, BRINGUP, STUDIES, REPORT, CLI = (
    f"{FACE}_{name}"
    for name in ("msgs_py", "description", "control", "sim", "supervisor", "bringup", "studies", "report", "cli")
)
BASE = {MSGS, DESCRIPTION}
DOING = BASE | {CONTROL, SIM, SUPERVISOR}
MAY_IMPORT = {
    MSGS: {MSGS},
    DESCRIPTION: BASE,
    CONTROL: BASE | {CONTROL},
    SIM: BASE | {SIM},
    SUPERVISOR: BASE | {SUPERVISOR},
    BRINGUP: DOING | {BRINGUP},
    STUDIES: DOING | {BRINGUP, STUDIES},
    REPORT: DOING | {BRINGUP, STUDIES, REPORT},
    CLI: DOING | {BRINGUP, STUDIES, REPORT, CLI},
    FACE: DOING | {BRINGUP, STUDIES, REPORT, FACE},
}
ROS = ("rclpy", "domain_coordinator", "std_msgs", "std_srvs", "sensor_msgs", "nav_msgs", "geometry_msgs")
ROS += ("trajectory_msgs", "diagnostic_msgs", "rosgraph_msgs", "builtin_interfaces", "rcl_interfaces")
ROS += ("lifecycle_msgs", "tf2_msgs")
ROOMS = dict.fromkeys(("matplotlib", "plotly", "viser", "rerun", "foxglove"), REPORT)
ROOMS |= dict.fromkeys(("typer", "rich"), CLI)
ROS_FILES = {f"{MSGS}/ros.py", f"{BRINGUP}/modes/graph.py", f"{BRINGUP}/modes/context.py"}
MAX_SHARE = 0.30


def files_of(package: str) -> list[Path]:
    found = sorted((ROOT / package).rglob("*.py"))
    assert found, f"{package} has no files"
    return found


def modules_in(path: Path) -> list[tuple[int, str]]:
    """(line, dotted module) of every absolute import in a file; of ``from a import b`` both a and a.b."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found += [(node.lineno, node.module)]
            found += [(node.lineno, f"{node.module}.{alias.name}") for alias in node.names]
    return found


def imports(path: Path) -> list[tuple[int, str]]:
    """(line, top-level package) of every absolute import in a file."""
    return sorted({(line, name.split(".")[0]) for line, name in modules_in(path)})


def ros_is_allowed(path: Path) -> bool:
    relative = path.relative_to(ROOT)
    return "nodes" in relative.parts or relative.as_posix() in ROS_FILES


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_packages_import_only_what_the_architecture_allows(package: str) -> None:
    """No file imports a package above its own, ROS outside its few files, or a library outside its room."""
    wrong = []
    for path in files_of(package):
        for line, name in imports(path):
            where = f"{path.relative_to(ROOT)}:{line} imports {name}"
            if name.startswith("space_robot") and name not in MAY_IMPORT[package]:
                wrong.append(where)
            if name in ROS and not ros_is_allowed(path):
                wrong.append(where)
            if ROOMS.get(name, package) != package:
                wrong.append(where)
    assert wrong == []


def test_no_module_imports_itself_through_others() -> None:
    """The modules can be put in an order in which each imports only earlier ones; lazy imports count, too."""
    arrows = {}
    for package in MAY_IMPORT:
        for path in files_of(package):
            name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
            arrows[name] = {module for _, module in modules_in(path)}
    waiting = {name: {other for other in others if other in arrows} - {name} for name, others in arrows.items()}
    while free := {name for name, others in waiting.items() if not others}:
        waiting = {name: others - free for name, others in waiting.items() if name not in free}
    assert sorted(waiting) == []


def test_no_test_module_imports_another() -> None:
    """What several test modules need lies beside them, or in tests/support."""
    files = sorted((ROOT / "tests").rglob("*.py"))
    wrong = [(path.name, name) for path in files for _, name in modules_in(path) if name.startswith("tests.")]
    assert [pair for pair in wrong if pair[1].rpartition(".")[2].startswith("test_")] == []
    assert wrong


def test_no_package_outgrows_the_others() -> None:
    """No package holds more than 30 % of the lines."""
    lines = {
        package: sum(path.read_text(encoding="utf-8").count("\n") for path in files_of(package))
        for package in MAY_IMPORT
    }
    shares = {package: count / sum(lines.values()) for package, count in lines.items()}
    assert max(shares.values()) <= MAX_SHARE, shares


def test_kernels_take_only_kernels_from_elsewhere() -> None:
    """Machine code contains only text of kernel folders, which the cache watches; types come from elsewhere."""
    types = {f"{MSGS}.interfaces.Vector", f"{MSGS}.errors.SpecError"}
    wrong = []
    for package in MAY_IMPORT:
        for path in files_of(package):
            if path.parent.name != "kernel":
                continue
            for line, name in modules_in(path):
                outside = name.startswith("space_robot") and ".kernel" not in name
                if outside and name not in types and name not in {kind.rpartition(".")[0] for kind in types}:
                    wrong.append(f"{path.relative_to(ROOT)}:{line} imports {name}")
    assert wrong == []


def test_everything_but_the_nodes_imports_without_ros() -> None:
    """On a machine without ROS every module outside nodes/ and the files that compose a graph can be imported."""
    # Of half a gigabyte, which only those install who look at it.
    needs_more = {f"{BRINGUP}.modes.processes", "space_robot_report.rerun_recording"}
    modules = [
        ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for package in MAY_IMPORT
        for path in files_of(package)
        if not ros_is_allowed(path) and path.name != "__init__.py"
    ]
    block = f"import sys, importlib\nfor name in {ROS!r}: sys.modules[name] = None\n"
    load = f"for name in {[m for m in modules if m not in needs_more]!r}: importlib.import_module(name)\n"
    done = subprocess.run([sys.executable, "-c", block + load], capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
