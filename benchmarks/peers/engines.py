"""MuJoCo and Basilisk behind one question: a task as a line of JSON in, final state and CPU seconds as a line out.

Run by ``benchmarks.accuracy`` with the Python of an environment that has ``mujoco`` and ``bsk``; imports nothing of
this project.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from time import process_time
from typing import Any

import numpy as np

State = tuple[list[float], list[float]]


def mujoco(task: dict[str, Any], step: float) -> tuple[Callable[[int], None], Callable[[], State]]:
    """RK4 at a fixed step; ``mj_step`` is called once per period."""
    import mujoco as mj

    model = mj.MjModel.from_xml_string(_with_motors(task).replace('timestep="0.005"', f'timestep="{step!r}"'))
    data, count, efforts = mj.MjData(model), round(0.1 / step), np.array(task["efforts"])
    data.qpos[:], data.qvel[:] = _pose(task["q"]), task["v"]

    def period(k: int) -> None:
        data.ctrl[:] = efforts[k]
        mj.mj_step(model, data, count)

    return period, lambda: (data.qpos.tolist(), data.qvel.tolist())


def basilisk(
    task: dict[str, Any], kind: str, step: float, tolerance: float | None
) -> tuple[Callable[[int], None], Callable[[], State]]:
    """An MJScene; a message for every motor, then the simulation goes on to the end of the period."""
    from Basilisk.architecture import messaging
    from Basilisk.simulation import mujoco as scenes
    from Basilisk.simulation import svIntegrators
    from Basilisk.utilities import SimulationBaseClass, macros

    simulation = SimulationBaseClass.SimBaseClass()
    simulation.CreateNewProcess("process").addTask(simulation.CreateNewTask("task", macros.sec2nano(step)))
    scene = scenes.MJScene(_with_motors(task))
    scene.highOrderAttitudeIntegration = True
    simulation.AddModelToTask("task", scene)
    integrator = getattr(svIntegrators, f"svIntegrator{kind}")(scene)
    if tolerance is not None:
        integrator.setRelativeTolerance(tolerance)
        integrator.setAbsoluteTolerance(0.01 * tolerance)
    scene.setIntegrator(integrator)
    messages = [messaging.SingleActuatorMsg() for _ in task["joints"]]
    for name, message in zip(task["joints"], messages, strict=True):
        message.write(messaging.SingleActuatorMsgPayload())
        scene.getSingleActuator(f"{name}_motor").actuatorInMsg.subscribeTo(message)
    simulation.InitializeSimulation()
    _start(scene, task)
    payload = messaging.SingleActuatorMsgPayload()

    def period(k: int) -> None:
        for message, effort in zip(messages, task["efforts"][k], strict=True):
            payload.input = effort
            message.write(payload, macros.sec2nano(0.1 * k))
        simulation.ConfigureStopTime(macros.sec2nano(0.1 * (k + 1)))
        simulation.ExecuteSimulation()

    def state() -> State:
        found = scene.stateOutMsg.read()
        return np.ravel(found.qpos).tolist(), np.ravel(found.qvel).tolist()

    # Otherwise it is collected while the scene goes on to use it.
    period.integrator = integrator  # type: ignore[attr-defined]
    return period, state


def _start(scene: Any, task: dict[str, Any]) -> None:
    """The base is at attitude zero, where frames of velocities do not differ."""
    q, v = task["q"], task["v"]
    base = scene.getBody(task["bodies"][0])
    base.setPosition(q[:3])
    base.setVelocity(v[:3])
    base.setAttitude([0.0, 0.0, 0.0])
    base.setAttitudeRate(v[3:6])
    for i, name in enumerate(task["joints"]):
        joint = scene.getBody(name).getScalarJoint(f"{name}_joint")
        joint.setPosition(q[7 + i])
        joint.setVelocity(v[6 + i])


def _with_motors(task: dict[str, Any]) -> str:
    motors = "".join(f'<motor name="{name}_motor" joint="{name}_joint"/>' for name in task["joints"])
    text: str = task["xml"]
    return text.replace("</mujoco>", f"<actuator>{motors}</actuator></mujoco>")


def _pose(q: list[float]) -> list[float]:
    """Quaternions have w first there."""
    return [*q[:3], q[6], *q[3:6], *q[7:]]


def answer(question: dict[str, Any]) -> dict[str, Any]:
    """One run: CPU seconds per period, and qpos and qvel at its end."""
    task = question["task"]
    if question["engine"] == "mujoco":
        period, state = mujoco(task, question["step"])
    else:
        period, state = basilisk(task, question["kind"], question["step"], question["tolerance"])
    count = len(task["efforts"])
    began = process_time()
    for k in range(count):
        period(k)
    seconds = (process_time() - began) / count
    qpos, qvel = state()
    return {"seconds": seconds, "qpos": qpos, "qvel": qvel}


def versions() -> dict[str, str]:
    """Of the engines that are there."""
    from importlib.metadata import PackageNotFoundError, version

    found = {}
    for name in ("mujoco", "bsk"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def main() -> None:
    """Answer one line after the other; the first one says which versions there are."""
    # What engines print on their own goes elsewhere.
    out, sys.stdout = sys.stdout, sys.stderr
    print(json.dumps(versions()), file=out, flush=True)
    for line in sys.stdin:
        print(json.dumps(answer(json.loads(line))), file=out, flush=True)


if __name__ == "__main__":
    main()
