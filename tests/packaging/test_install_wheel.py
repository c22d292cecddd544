"""From a wheel in a fresh environment, everything is found, and every node starts, tells its parameters and stops."""

from __future__ import annotations

import json
import os
import signal
import subprocess
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic
from typing import Any

import pytest

from tests.support.distribution import executables, foreign_environment, make_venv
from tests.support.follow import DEADLINE, ended

pytest.importorskip("rclpy")
from rcl_interfaces.srv import ListParameters
from rclpy.node import Node

from space_robot_bringup.modes.context import local_context, reserved_domain
from space_robot_bringup.modes.graph import make_executor

pytestmark = [pytest.mark.ros, pytest.mark.slow, pytest.mark.xdist_group("wheel")]

ASK_SECONDS = 15.0
PACKAGES = [
    "space_robot",
    *(f"space_robot_{name}" for name in ("msgs_py", "description", "control", "sim", "supervisor", "bringup")),
]
REPLAYER = "space_robot_sim/replayer"
EXPERIMENT = ["--experiment", "liu2023/fig08"]
MORE = {"space_robot_supervisor/supervisor": ["--set", "supervision=mini_basic"]}
FIND = """
import json, os
from pathlib import Path
from ament_index_python import get_package_share_directory, get_packages_with_prefixes
found = {name: Path(at) for name, at in get_packages_with_prefixes().items() if name.startswith("space_robot")}
nodes = [exe for name, at in found.items() for exe in (at / "lib" / name).glob("*") if os.access(exe, os.X_OK)]
shares = {name: os.listdir(get_package_share_directory(name)) for name in ("space_robot", "space_robot_bringup")}
print(json.dumps({"packages": [*found], "nodes": ["/".join(exe.parts[-2:]) for exe in nodes], "shares": shares}))
"""


@pytest.fixture(scope="module")
def prefix(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the wheel was installed with its ROS extra."""
    return make_venv(tmp_path_factory.mktemp("installed") / "venv", [f"{wheel}[ros]"])


def test_the_ament_index_finds_every_package_and_executable(prefix: Path, tmp_path: Path) -> None:
    """``ros2 pkg``, ``ros2 run`` and ``ros2 launch`` look things up there and find all of them."""
    said = _run(prefix, str(prefix / "bin" / "python"), "-c", FIND, cwd=tmp_path).stdout
    found = json.loads(said)
    assert sorted(found["packages"]) == sorted(PACKAGES)
    assert sorted(found["nodes"]) == executables()
    assert {"config", "examples", "package.xml"} <= set(found["shares"]["space_robot"])
    assert sorted(found["shares"]["space_robot_bringup"]) == ["launch", "package.xml"]


def test_the_command_line_finds_what_is_shipped(prefix: Path, tmp_path: Path) -> None:
    """Experiments, papers, campaigns and robots are there, from any folder, and so is the law of the examples."""
    said = _run(prefix, str(prefix / "bin" / "space-robot"), "list", cwd=tmp_path).stdout
    for name in ("liu2023/fig08", "compare_mini", "giordano2023", "servicer"):
        assert name in said
    law = f"controller.law={prefix}/share/space_robot/examples/my_law.py:PdPlus"
    _run(prefix, str(prefix / "bin" / "space-robot"), "check", "liu2023/fig08", "--set", law, cwd=tmp_path)


@pytest.fixture(scope="module")
def bag(prefix: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short run, for the replayer."""
    run = tmp_path_factory.mktemp("recorded") / "run"
    run_arguments = ["run", "liu2023/fig08", "--set", "controller.law=pd", "--duration", "1.0", "--out", str(run)]
    completed = subprocess.run(
        [str(prefix / "bin" / "space-robot"), *run_arguments],
        env=foreign_environment(NUMBA_DISABLE_JIT="1"),
        capture_output=True,
        text=True,
        check=False,
    )
    # One second is too short to settle, which is the verdict and not the point.
    assert completed.returncode == 1, completed.stderr
    return run


@pytest.mark.parametrize("turn", [0, pytest.param(1, marks=pytest.mark.thorough)])
def test_every_node_starts_lists_its_parameters_and_stops(prefix: Path, bag: Path, tmp_path: Path, turn: int) -> None:
    """It appears in the graph, lists its parameters and ends with 0 on SIGINT and SIGTERM, leaving no process.

    Each is alone on its domain; which of them gets which signal goes by turns.
    """
    with ExitStack() as domains:
        nodes = {name: domains.enter_context(reserved_domain()) for name in executables()}
        children = {name: _start(prefix, name, bag, tmp_path / name, domain) for name, domain in nodes.items()}
        with ended([*children.values()]):
            for name, domain in nodes.items():
                with _observer(domain) as observer:
                    listed = observer("/one/node", children[name])
                assert ("use_sim_time" if name == REPLAYER else "experiment") in listed, name
            for index, child in enumerate(children.values()):
                child.send_signal((signal.SIGINT, signal.SIGTERM)[(index + turn) % 2])
            said = {name: child.communicate(timeout=DEADLINE)[0] for name, child in children.items()}
    for name, child in children.items():
        assert child.returncode == 0, (name, said[name])
        assert "Traceback" not in said[name]
        with pytest.raises(ProcessLookupError):
            os.killpg(child.pid, 0)


@pytest.mark.parametrize("executable", executables())
def test_every_node_explains_itself(prefix: Path, tmp_path: Path, executable: str) -> None:
    """``--help`` says what it takes, under the name of the executable."""
    said = _run(prefix, str(prefix / "lib" / executable), "--help", cwd=tmp_path).stdout
    assert f"usage: {Path(executable).name} " in said
    assert ("bag" if executable == REPLAYER else "--experiment") in said


def _run(prefix: Path, *command: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    environment = foreign_environment(AMENT_PREFIX_PATH=str(prefix))
    done = subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return done


def _start(prefix: Path, name: str, bag: Path, run: Path, domain: int) -> subprocess.Popen[str]:
    arguments = [*EXPERIMENT, "--out", str(run), *MORE.get(name, [])]
    if name == REPLAYER:
        arguments = [str(bag), "--paused"]
    renamed = ["--ros-args", "-r", "__ns:=/one", "-r", "__node:=node"]
    return subprocess.Popen(
        [str(prefix / "lib" / name), *arguments, *renamed],
        # Nothing is run here: compiling would take far longer than all the rest.
        env=foreign_environment(ROS_DOMAIN_ID=str(domain), NUMBA_DISABLE_JIT="1"),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


@contextmanager
def _observer(domain: int) -> Iterator[Callable[[str, subprocess.Popen[str]], list[str]]]:
    """Asks a node of that domain for the names of its parameters, as soon as it answers."""
    with local_context(domain) as context:
        node = Node("observer", context=context, enable_rosout=False, start_parameter_services=False)
        executor = make_executor(context)
        executor.add_node(node)

        def ask(name: str, child: subprocess.Popen[str]) -> list[str]:
            client: Any = node.create_client(ListParameters, f"{name}/list_parameters")
            deadline = monotonic() + DEADLINE
            while True:
                assert child.poll() is None, f"{name} ended with {child.returncode}: {child.communicate()[0]}"
                assert monotonic() < deadline, f"waited {DEADLINE} s for the parameters of {name}"
                if not client.wait_for_service(timeout_sec=0.1):
                    continue
                # A service that is there may yet not have discovered who asks: who only reads asks again.
                answer = client.call_async(ListParameters.Request())
                executor.spin_until_future_complete(answer, timeout_sec=ASK_SECONDS)
                if answer.done():
                    return list(answer.result().result.names)

        try:
            yield ask
        finally:
            executor.shutdown()
            node.destroy_node()
