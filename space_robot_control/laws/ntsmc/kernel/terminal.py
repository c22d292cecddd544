"""From tracking errors to the errors of the terminal sliding mode, and from its terms to accelerations.

The symbols are those of ``TerminalSliding`` and ``Ntsmc``: [Giordano and Cenedese 2023, sec. IV].
"""

from __future__ import annotations

from space_robot_control.laws.ntsmc.kernel.sliding import EQUIVALENT, REACHING
from space_robot_description.kernel.jit import kernel
from space_robot_description.kernel.quaternion import attitude, put, rotate, rotate_inverse, three
from space_robot_description.kernel.spatial import add, cross, scaled, sub
from space_robot_msgs_py.interfaces import Vector

# Rows of the errors of the base rotation, and of the stacked errors.
E, RATE, E_DOT, DESIRED = range(4)


@kernel
def rotation_errors(
    q: Vector, v: Vector, q_d: Vector, a_d: Vector, quaternion: Vector, velocity: Vector, out: Vector
) -> None:
    """Write the errors of the quaternion law in the inertial frame: rows e, rate, e_dot and desired of (4, 3).

    Args:
        q: (7+n,) of the state.
        v: (6+n,) of the state.
        q_d: (7+n,) of the reference.
        a_d: (6+n,) of the reference.
        quaternion: (4,) of the tracking errors.
        velocity: (6+n,) of the tracking errors.
        out: (4, 3) written.
    """
    frame, eta = attitude(q), quaternion[3]
    # R_e = R^T R_d is the inverse of q_e seen from the body; its quaternion already goes the short way.
    eps = rotate(frame, scaled(-1.0, three(quaternion, 0)))
    w_e, omega = rotate(frame, scaled(-1.0, three(velocity, 3))), rotate(frame, three(v, 3))
    put(out[E], 0, eps)
    put(out[RATE], 0, w_e)
    put(out[E_DOT], 0, scaled(0.5, sub(scaled(eta, w_e), cross(eps, sub(scaled(2.0, omega), w_e)))))
    put(out[DESIRED], 0, rotate(attitude(q_d), three(a_d, 3)))


@kernel
def stack(q: Vector, configuration: Vector, velocity: Vector, rotation: Vector, out: Vector) -> None:
    """Write e, its rate and its derivative: [translation in the inertial frame, rotation, joints].

    Args:
        q: (7+n,) of the state.
        configuration: (6+n,) of the tracking errors: desired minus actual.
        velocity: (6+n,) of the tracking errors.
        rotation: (4, 3) see ``rotation_errors``.
        out: (3, m) written; m = 3+n: the translation is left out.
    """
    first = out.shape[1] - (velocity.shape[0] - 3)
    for k in range(3):
        if first:
            part = velocity if k else configuration
            put(out[k], 0, rotate(attitude(q), scaled(-1.0, three(part, 0))))
        put(out[k], first, three(rotation[k], 0))
    for i in range(6, velocity.shape[0]):
        out[E, first - 3 + i] = -configuration[i]
        out[RATE, first - 3 + i] = -velocity[i]
        out[E_DOT, first - 3 + i] = -velocity[i]


@kernel
def accelerate(q: Vector, feedforward: Vector, desired: Vector, terms: Vector, turned: Vector, out: Vector) -> None:
    """Write the derivative of v that gives x''_d + a2 + a3 for translation and joints, and that of the rotation apart.

    Args:
        q: (7+n,) of the state.
        feedforward: (6+n,) of the tracking errors; its rotation is not used.
        desired: (3,) desired acceleration of the representation of rotation.
        terms: (6, m) of the sliding mode.
        turned: (3,) written: acceleration of the representation of rotation.
        out: (6+n,) written, but for entries 3 to 5.
    """
    first = terms.shape[1] - (out.shape[0] - 3)
    put(out, 0, three(feedforward, 0))
    if first:
        push = add(three(terms[EQUIVALENT], 0), three(terms[REACHING], 0))
        put(out, 0, add(three(out, 0), rotate_inverse(attitude(q), push)))
    for i in range(6, out.shape[0]):
        out[i] = feedforward[i] + (terms[EQUIVALENT, first - 3 + i] + terms[REACHING, first - 3 + i])
    for k in range(3):
        turned[k] = desired[k] + (terms[EQUIVALENT, first + k] + terms[REACHING, first + k])
