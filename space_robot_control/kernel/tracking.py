"""Tracking errors; the symbols are those of ``TrackingErrors``."""

from __future__ import annotations

from space_robot_description.kernel.jit import kernel
from space_robot_description.kernel.quaternion import attitude, log, put, relative, rotate, rotate_inverse, three
from space_robot_description.kernel.spatial import add, cross, sub
from space_robot_msgs_py.interfaces import Vector


@kernel
def track(
    q: Vector,
    v: Vector,
    q_d: Vector,
    v_d: Vector,
    a_d: Vector,
    configuration: Vector,
    velocity: Vector,
    feedforward: Vector,
    quaternion: Vector,
) -> None:
    """Write the fields of ``TrackingErrors``.

    Args:
        q: (7+n,) of the state.
        v: (6+n,) of the state.
        q_d: (7+n,) of the reference.
        v_d: (6+n,) of the reference.
        a_d: (6+n,) of the reference.
        configuration: (6+n,) written.
        velocity: (6+n,) written.
        feedforward: (6+n,) written.
        quaternion: (4,) written.
    """
    actual = attitude(q)
    to_body = relative(actual, attitude(q_d))
    omega, omega_d = three(v, 3), three(v_d, 3)
    seen = rotate(to_body, omega_d)
    pushed = add(three(a_d, 0), cross(omega_d, three(v_d, 0)))
    put(configuration, 0, rotate_inverse(actual, sub(three(q_d, 0), three(q, 0))))
    put(configuration, 3, log(to_body))
    put(velocity, 0, sub(rotate(to_body, three(v_d, 0)), three(v, 0)))
    put(velocity, 3, sub(seen, omega))
    put(feedforward, 0, sub(rotate(to_body, pushed), cross(omega, three(v, 0))))
    put(feedforward, 3, sub(rotate(to_body, three(a_d, 3)), cross(omega, seen)))
    for i in range(6, v.shape[0]):
        configuration[i], velocity[i], feedforward[i] = q_d[i + 1] - q[i + 1], v_d[i] - v[i], a_d[i]
    for i in range(4):
        quaternion[i] = to_body[i]
