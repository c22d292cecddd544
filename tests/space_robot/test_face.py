"""Faces: what a package names is there, typed, listed in one way only, and loaded no sooner than it is used."""

from __future__ import annotations

import ast
import inspect
import pkgutil
import re
import subprocess
import sys
from dataclasses import is_dataclass
from importlib import import_module
from importlib.metadata import entry_points, version
from pathlib import Path

import pytest
from mypy import api

import space_robot

ROOT = Path(__file__).parents[2]
PACKAGES = ("msgs_py", "description", "control", "sim", "bringup")
FACES = ("space_robot", *(f"space_robot_{name}" for name in PACKAGES))
HEAVY = ("numpy", "numba", "pinocchio", "pydantic", "rclpy", "matplotlib", "pandas", "typer", "rich")


def names() -> list[tuple[str, str]]:
    """(package, public name) of every face."""
    return [(package, name) for package in FACES for name in import_module(package).__all__]


def typed(package: str) -> dict[str, str]:
    """Public name to its module, as type checkers and editors read them."""
    tree = ast.parse(Path(str(import_module(package).__file__)).read_text(encoding="utf-8"))
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    assert ast.unparse(block.test) == "TYPE_CHECKING"
    lines = [line for line in block.body if isinstance(line, ast.ImportFrom)]
    assert len(lines) == len(block.body)
    return {alias.asname or alias.name: str(line.module) for line in lines for alias in line.names}


@pytest.mark.parametrize("package", FACES)
def test_lazy_names_type_stub_and_all_agree(package: str) -> None:
    """What is exported, what types are known of and what is loaded are the same names of the same modules."""
    face = import_module(package)
    loaded = {name: module for module, found in face._MODULES.items() for name in found}
    assert loaded == typed(package)
    assert sorted(face.__all__) == sorted(loaded) == dir(face)
    assert len(face.__all__) == len(set(face.__all__))


@pytest.mark.parametrize(("package", "name"), names())
def test_every_public_name_is_what_its_module_defines(package: str, name: str) -> None:
    """A name of a face is the object of that name in its module, documented where it is a class or a function."""
    value = getattr(import_module(package), name)
    assert value is getattr(import_module(typed(package)[name]), name)
    if inspect.isclass(value) or inspect.isfunction(value):
        assert (value.__doc__ or "").strip()


@pytest.mark.parametrize("package", FACES)
def test_no_public_name_is_a_module_of_its_package(package: str) -> None:
    """Whether a name is an object or a module must not depend on what was imported before."""
    modules = {module.name for module in pkgutil.iter_modules(import_module(package).__path__)}
    assert not modules & set(import_module(package).__all__)


def test_a_name_that_is_not_there_is_an_error_that_knows_the_others() -> None:
    """A typo is an AttributeError from which Python can suggest the right name."""
    with pytest.raises(AttributeError, match=r"'space_robot' has no attribute 'rum'") as caught:
        space_robot.rum  # type: ignore[attr-defined]  # noqa: B018
    assert (caught.value.name, caught.value.obj) == ("rum", space_robot)
    assert not hasattr(space_robot, "experiment")


@pytest.mark.parametrize("package", FACES)
def test_a_face_loads_nothing_heavy(package: str) -> None:
    """Importing a package, and listing its names, loads no other module of the project and no large library."""
    loaded = _python(f"import sys, {package}; dir({package}); print(*sys.modules)").split()
    assert package in loaded
    assert not {name.split(".")[0] for name in loaded} & set(HEAVY)
    allowed = {package, "space_robot_msgs_py", "space_robot_msgs_py.faces"}
    assert {name for name in loaded if name.startswith("space_robot")} <= allowed


def test_the_import_takes_less_than_that_of_numpy() -> None:
    """Processor time of a whole interpreter with the public face is below that with numpy, many times its work."""
    own, numpy = (min(float(_python(_TIMED.format(name))) for _ in range(3)) for name in ("space_robot", "numpy"))
    assert own < numpy


def test_reading_logs_loads_no_solver() -> None:
    """Logs, errors and value types are there without Pinocchio and numba, which take a second to load."""
    code = "import sys, space_robot as sr; sr.LogReader, sr.SpaceRobotError, sr.RobotState; print(*sys.modules)"
    assert not set(_python(code).split()) & {"pinocchio", "numba"}


@pytest.mark.slow
def test_type_checkers_know_every_name_and_no_other(tmp_path: Path) -> None:
    """A type checker sees the types behind the lazy names, and a misspelt one is an error."""
    script = tmp_path / "script.py"
    script.write_text(_SCRIPT, encoding="utf-8")
    said, _, _ = api.run([str(script), "--config-file", str(ROOT / "pyproject.toml")])
    assert re.search(r'3: note: Revealed type is "space_robot_bringup\.[\w.]+\.Run"', said), said
    assert re.search(r"4: note: Revealed type is .*ndarray.*float", said), said
    assert re.search(r'5: note: Revealed type is "(builtins\.)?str \| None"', said), said
    assert re.search(r'6: error: .*"mode".*\[arg-type\]', said), said
    assert '7: error: Module has no attribute "no_such_name"  [attr-defined]' in said, said
    assert "Found 2 errors" in said, said


def test_every_path_may_be_text() -> None:
    """No public function, and no class that is made from a path, insists on ``Path``."""
    found = [
        (f"{package}.{name}({parameter.name})", str(parameter.annotation))
        for package, name in names()
        for parameter in _parameters(getattr(import_module(package), name))
    ]
    assert sum("StrPath" in annotation for _, annotation in found) > 10
    assert [
        place for place, annotation in found if re.search(r"\bPath\b", annotation) and "str" not in annotation
    ] == []


def test_the_version_is_that_of_the_installation() -> None:
    """``__version__`` is what pip installed, which is what pyproject.toml says."""
    assert space_robot.__version__ == version("space-robot")
    assert f'version = "{space_robot.__version__}"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")


def test_the_plot_entry_point_exists() -> None:
    """The figure of a run is found where the installation says it is."""
    pytest.importorskip("matplotlib")
    (figure,) = entry_points(group="space_robot.figures", name="run")
    assert callable(figure.load())


def test_the_page_lists_the_public_names() -> None:
    """docs/python.md has one row for each name, and no other."""
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    section = page.split("## The names")[1].split("##")[0]
    cells = [line.split("|")[1] for line in section.splitlines() if line.startswith("| `")]
    assert sorted(name for cell in cells for name in re.findall(r"`(\w+)`", cell)) == sorted(space_robot.__all__)


def _parameters(value: object) -> list[inspect.Parameter]:
    """Of a function or a class that is called; a dataclass is a value that functions return."""
    if not (inspect.isfunction(value) or inspect.isclass(value)) or is_dataclass(value):
        return []
    function = value.__init__ if inspect.isclass(value) else value
    return [*inspect.signature(function).parameters.values()]


_SCRIPT = """import space_robot as sr
run = sr.run("liu2023/fig08", {"controller.gains.lambda": 0.7}, out="runs/x")
reveal_type(run)
reveal_type(run.arrays.joints.position)
reveal_type(sr.LogReader(run).end_reason)
sr.run("liu2023/fig08", mode="grap")
sr.no_such_name
"""
_TIMED = "import time, {}; print(time.process_time())"


def _python(code: str) -> str:
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout
