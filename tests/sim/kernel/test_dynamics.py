"""The articulated-body kernel against Pinocchio, and how it is compiled."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from space_robot_description.kernel import jit
from space_robot_description.kernel.arrays import robot_arrays
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Command
from space_robot_sim.kernel.aba import forward_dynamics
from space_robot_sim.kernel.articulated import WORKSPACE
from space_robot_sim.kernel.momentum import balance
from space_robot_sim.kernel.period import advance
from space_robot_sim.plant import InitialState, SimulatedRobot
from tests.support.paths import ROOT
from tests.support.robots import arm_model, random_model, random_state, robot_of


def _case(seed: int) -> tuple[Any, np.random.Generator, int, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    joints = int(rng.integers(0, 12))
    model = random_model(rng, joints, serial=seed % 2 == 0)
    return model, rng, joints, *random_state(rng, joints)


@pytest.mark.parametrize("seed", range(100))
def test_accelerations_equal_pinocchio(seed: int) -> None:
    """On any tree of revolute and prismatic joints the kernel gives pin.aba's accelerations to 1e-12."""
    model, rng, joints, q, v = _case(seed)
    y, u = np.concatenate([q, v]), rng.normal(size=6 + joints) * 5.0
    dy = np.zeros_like(y)
    force, torque = tuple(u[:3].tolist()), tuple(u[3:6].tolist())
    forward_dynamics(robot_arrays(model), y, force, torque, u[6:], np.zeros((1 + joints, WORKSPACE)), dy)
    expected = pin.aba(model, model.createData(), q, v, u)
    np.testing.assert_allclose(dy[7 + joints :], expected, rtol=0.0, atol=1e-12 * max(1.0, np.abs(expected).max()))


@pytest.mark.parametrize("joints", [14, 44])
def test_accelerations_of_large_trees_equal_pinocchio(joints: int) -> None:
    """As many joints as two arms and as a humanoid have, in random trees."""
    rng = np.random.default_rng(joints)
    model, (q, v) = random_model(rng, joints), random_state(rng, joints, 0.3)
    y, u = np.concatenate([q, v]), rng.normal(size=6 + joints) * 5.0
    dy, work = np.zeros_like(y), np.zeros((1 + joints, WORKSPACE))
    forward_dynamics(robot_arrays(model), y, tuple(u[:3].tolist()), tuple(u[3:6].tolist()), u[6:], work, dy)
    expected = pin.aba(model, model.createData(), q, v, u)
    np.testing.assert_allclose(dy[7 + joints :], expected, rtol=0.0, atol=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize("seed", range(10))
def test_balance_equals_pinocchio(seed: int) -> None:
    """Momentum about the inertial origin and kinetic energy are those of pin.ccrba and computeKineticEnergy."""
    model, _, joints, q, v = _case(seed)
    data, out = model.createData(), np.zeros(9)
    no_wheels = np.zeros((3, 0)), np.zeros(0)
    balance(robot_arrays(model), np.concatenate([q, v]), *no_wheels, np.zeros((1 + joints, WORKSPACE)), out)
    pin.ccrba(model, data, q, v)
    linear, centroidal = data.hg.linear, data.hg.angular
    np.testing.assert_allclose(out[:3], linear, rtol=1e-12, atol=1e-10)
    np.testing.assert_allclose(out[3:6], centroidal + np.cross(data.com[0], linear), rtol=1e-12, atol=1e-10)
    assert out[6] == pytest.approx(pin.computeKineticEnergy(model, data, q, v), rel=1e-12)
    assert out[7] >= np.linalg.norm(out[:3]) - 1e-9
    assert out[8] >= np.linalg.norm(out[3:6]) - 1e-9


def test_wheels_add_their_momentum() -> None:
    """A wheel's momentum is added along its axis, turned into the inertial frame."""
    model, _, joints, q, v = _case(3)
    arrays, y, work = robot_arrays(model), np.concatenate([q, v]), np.zeros((1 + joints, WORKSPACE))
    without, with_wheel = np.zeros(9), np.zeros(9)
    balance(arrays, y, np.zeros((3, 0)), np.zeros(0), work, without)
    balance(arrays, y, np.array([[0.6], [0.8], [0.0]]), np.array([2.0]), work, with_wheel)
    added = pin.Quaternion(q[3:7]).matrix() @ np.array([1.2, 1.6, 0.0])
    np.testing.assert_allclose(with_wheel[3:6] - without[3:6], added, atol=1e-12)
    assert with_wheel[6] == without[6]


def _with_gravity(model: Any) -> Any:
    model.gravity = pin.Motion(np.array([0.0, 0.0, -9.81]), np.zeros(3))
    return model


def _with_armature(model: Any) -> Any:
    model.armature = np.full(model.nv, 0.1)
    return model


def _with_spherical(model: Any) -> Any:
    joint = model.addJoint(1, pin.JointModelSpherical(), pin.SE3.Identity(), "ball")
    model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Identity())
    return model


def _fixed_base(_: Any) -> Any:
    return pin.buildSampleModelManipulator()


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (_with_gravity, "gravity is not zero"),
        (_with_armature, "armature"),
        (_with_spherical, "ball does not have one degree of freedom"),
        (_fixed_base, "not a free-flyer"),
    ],
)
def test_refuses_other_models(spoil: Any, message: str) -> None:
    """A model the kernel does not describe is refused with the reason."""
    model = spoil(random_model(np.random.default_rng(0), 3))
    with pytest.raises(SpecError, match=message):
        robot_arrays(model)


@pytest.mark.skipif(not jit.COMPILED, reason="numba is not installed")
def test_cache_watches_every_kernel_file() -> None:
    """The cached machine code of an entry is tied to the digest of all kernel sources, not to one file's date."""
    compiled: Any = advance
    assert compiled._cache._cache_file._source_stamp == jit.digest(compiled.py_func)


CALLEE = """
from space_robot_description.kernel.jit import inner

@inner
def scaled(x):
    return {factor} * x
"""
CALLER = """
from made.shared.kernel.callee import scaled
from space_robot_description.kernel.jit import kernel

@kernel
def call(x):
    return scaled(x)
"""


@pytest.mark.skipif(not jit.COMPILED, reason="numba is not installed")
def test_an_edited_callee_of_another_folder_is_compiled_again(tmp_path: Path) -> None:
    """A cached kernel is not used any more once a function it inlines from another kernel folder was edited."""
    for folder in ("made/shared/kernel", "made/law/kernel"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "made/law/kernel/caller.py").write_text(CALLER)
    text = "from made.law.kernel.caller import call; print(call(1.5), sum(call.stats.cache_hits.values()))"
    environment = os.environ | {"PYTHONPATH": str(tmp_path), "PYTHONDONTWRITEBYTECODE": "1"}
    environment.pop("NUMBA_CACHE_DIR", None)
    seen = []
    for factor in ("2.0", "2.0", "3.0"):
        (tmp_path / "made/shared/kernel/callee.py").write_text(CALLEE.format(factor=factor))
        command = [sys.executable, "-c", text]
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment, cwd=ROOT)
        assert done.returncode == 0, done.stderr
        seen.append(done.stdout.split())
    assert seen == [["3.0", "0"], ["3.0", "1"], ["4.5", "0"]]


def test_compiles_where_nothing_can_be_cached(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where numba finds no folder to cache in, the kernel is compiled without a cache."""

    class ReadOnly:
        @staticmethod
        def njit(cache: bool = False, **_: object) -> Any:
            if cache:
                raise RuntimeError("cannot cache function: no locator available")
            return lambda function: function

    monkeypatch.setattr(jit, "numba", ReadOnly)

    def twice(x: float) -> float:
        return 2.0 * x

    assert jit.kernel(twice)(2.0) == 4.0


WITHOUT_NUMBA = """
import sys
sys.modules["numba"] = None
import numpy as np
from space_robot_msgs_py.interfaces import Command
from space_robot_sim.spec import IntegratorSpec
from space_robot_sim.plant import InitialState, SimulatedRobot
from tests.support.robots import arm_model, random_state, robot_of

state = random_state(np.random.default_rng(0), 7, 0.05)
robot = robot_of(arm_model())
plant = SimulatedRobot(robot, control_period=100_000_000, initial=InitialState(*state), integrator=IntegratorSpec())
plant.reset()
for k in range(5):
    sample = plant.step(Command(k, np.full(6, 0.1), np.full(7, 0.01)))
print(*[float(x).hex() for x in sample.state.q])
try:
    SimulatedRobot(robot, control_period=1, initial=InitialState(*state), integrator=IntegratorSpec(kernel="numba"))
except ValueError as error:
    print(error)
"""


def test_runs_without_numba() -> None:
    """Without numba everything imports, runs over pinocchio to the same state, and refuses only `kernel: numba`."""
    done = subprocess.run([sys.executable, "-c", WITHOUT_NUMBA], capture_output=True, text=True, check=True, cwd=ROOT)
    numbers, refusal = done.stdout.splitlines()
    state = InitialState(*random_state(np.random.default_rng(0), 7, 0.05))
    plant = SimulatedRobot(robot_of(arm_model()), control_period=100_000_000, initial=state)
    plant.reset()
    for k in range(5):
        sample = plant.step(Command(k, np.full(6, 0.1), np.full(7, 0.01)))
    np.testing.assert_allclose([float.fromhex(x) for x in numbers.split()], sample.state.q, rtol=0.0, atol=1e-12)
    assert "numba is not installed" in refusal
