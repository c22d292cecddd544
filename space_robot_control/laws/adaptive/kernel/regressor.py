"""The regressor of Slotine and Li, body by body, and the sums that need only the estimated parameters.

A body with m, h = m c and inertia J about its origin, whose origin accelerates with a, needs at its origin

    f = m a + alpha x h + 1/2 [w x (w_r x h) + w_r x (w x h)]
    n = h x a + J alpha + 1/2 [w x J w_r + w_r x J w]

(`kernel.motion` for the polarised motion), which is linear in [m, h, J]. A degree of freedom feels the part of both
along its axis, of every body that it carries.
"""

from __future__ import annotations

from space_robot_control.laws.adaptive.kernel.motion import ACCELERATION, ALPHA, OMEGA, OMEGA_R, accelerate, move
from space_robot_control.laws.adaptive.kernel.tree import ALONG, BASE, PLACE, THROUGH, TURN, Places, Tree, place
from space_robot_description.kernel.coupling import COORDINATE, MULTIPLIER
from space_robot_description.kernel.jit import constants, inner, kernel
from space_robot_description.kernel.spatial import Mat, Sym, Vec, add, cross, dot, get3, get9, mul, mul_t, scaled, sub
from space_robot_msgs_py.interfaces import Vector

(PER_BODY,) = constants(10)  # [m, m c(3), Jxx, Jxy, Jyy, Jxz, Jyz, Jzz]

Motion = tuple[Vec, Vec, Vec, Vec]  # omega, omega_r, alpha, acceleration, in body axes


@kernel
def slotine_li(
    tree: Tree,
    at: Places,
    x: Vector,
    dx: Vector,
    dx_r: Vector,
    ddx_r: Vector,
    parameters: Vector,
    free_base: bool,
    Y: Vector,
) -> None:
    """Write Y (6+n, P) with Y pi = M x_r'' + C(x, x') x_r'; the bodies are left with that motion.

    Args:
        tree: geometry of the robot.
        at: memory.
        x: (6+n,) Euler coordinates [m, rad].
        dx: (6+n,) x' [m/s, rad/s].
        dx_r: (6+n,) x_r' [m/s, rad/s].
        ddx_r: (6+n,) x_r'' [m/s2, rad/s2].
        parameters: (P,) pi, P = 10 (1+N).
        free_base: x_r'' of the base is the given one and what it takes for no force on it, with these parameters.
        Y: (6+n, P) receives Y.
    """
    place(tree, x, at)
    move(tree, dx, dx_r, ddx_r, at)
    if free_base:
        _let_base_float(parameters, at)
    if tree.coupling.shape[0]:
        _fill_all(tree, at, at.rows)
        _join(tree.coupling, at.rows, Y)
    else:
        _fill_all(tree, at, Y)


@inner
def _join(coupling: Vector, rows: Vector, Y: Vector) -> None:
    """Write the rows of coordinates (6+n, P): those of all joints (6+N, P) that each moves, times how far it does."""
    Y[6:] = 0.0
    for column in range(Y.shape[1]):
        for dof in range(BASE):
            Y[dof, column] = rows[dof, column]
        for joint in range(coupling.shape[0]):
            dof = BASE + int(coupling[joint, COORDINATE])
            Y[dof, column] += coupling[joint, MULTIPLIER] * rows[BASE + joint, column]


@inner
def _fill_all(tree: Tree, at: Places, Y: Vector) -> None:
    """Write the rows of all degrees of freedom (6+N, P)."""
    Y[:] = 0.0
    for body in range(tree.parent.shape[0]):
        motion = _in_body(at.bodies, body)
        bent = _bending(motion)
        for dof in range(BASE):
            _fill(tree, at, body, dof, motion, bent, Y)
        node = body
        while node > 0:
            _fill(tree, at, body, BASE + node - 1, motion, bent, Y)
            node = tree.parent[node]


@inner
def total_mass(parameters: Vector) -> float:
    """Mass of all bodies with these parameters (10 (1+n),) [kg]."""
    mass = 0.0
    for k in range(0, parameters.shape[0], PER_BODY):
        mass += parameters[k]
    return mass


@inner
def _let_base_float(parameters: Vector, at: Places) -> None:
    """Give the base the translation that needs no force, with these parameters (10 (1+n),)."""
    force = (0.0, 0.0, 0.0)
    for body in range(at.bodies.shape[0]):
        motion, k = _in_body(at.bodies, body), PER_BODY * body
        needed = add(scaled(parameters[k], motion[3]), mul(_bending(motion), _moment(parameters, k)))
        force = add(force, mul(get9(at.bodies, body, TURN), needed))
    accelerate(scaled(-1.0 / total_mass(parameters), force), at)


@inner
def momentum_and_energy(parameters: Vector, at: Places) -> tuple[Vec, float]:
    """Return p (3,), inertial axes, and s^T M s of a velocity s, the bodies having the motion x_r'' = s from rest."""
    momentum, energy = (0.0, 0.0, 0.0), 0.0
    for body in range(at.bodies.shape[0]):
        _, _, w, v = _in_body(at.bodies, body)
        k = PER_BODY * body
        h, mass = _moment(parameters, k), parameters[k]
        linear = add(scaled(mass, v), cross(w, h))
        angular = add(_turned_by(parameters, k, w), cross(h, v))
        momentum = add(momentum, mul(get9(at.bodies, body, TURN), linear))
        energy += dot(linear, v) + dot(angular, w)
    return momentum, energy


@inner
def _in_body(bodies: Vector, body: int) -> Motion:
    turn = get9(bodies, body, TURN)
    return (
        mul_t(turn, get3(bodies, body, OMEGA)),
        mul_t(turn, get3(bodies, body, OMEGA_R)),
        mul_t(turn, get3(bodies, body, ALPHA)),
        mul_t(turn, get3(bodies, body, ACCELERATION)),
    )


@inner
def _bending(motion: Motion) -> Mat:
    """B with f = m a + B h: [alpha x] + ([w x][w_r x] + [w_r x][w x]) / 2."""
    w, r, alpha, _ = motion
    along = dot(w, r)
    xy = 0.5 * (w[0] * r[1] + w[1] * r[0])
    xz = 0.5 * (w[0] * r[2] + w[2] * r[0])
    yz = 0.5 * (w[1] * r[2] + w[2] * r[1])
    return (
        w[0] * r[0] - along,
        xy - alpha[2],
        xz + alpha[1],
        xy + alpha[2],
        w[1] * r[1] - along,
        yz - alpha[0],
        xz - alpha[1],
        yz + alpha[0],
        w[2] * r[2] - along,
    )


@inner
def _fill(tree: Tree, at: Places, body: int, dof: int, motion: Motion, bent: Mat, Y: Vector) -> None:
    """One row of one body: how it moves with the degree of freedom, times what it needs."""
    turn, k = get9(at.bodies, body, TURN), PER_BODY * body
    along = get3(at.axes, dof, ALONG)
    w, r, alpha, a = motion
    if tree.slides[dof]:
        pull = mul_t(turn, along)
        moment = mul_t(bent, pull)
    else:
        arm = sub(get3(at.bodies, body, PLACE), get3(at.axes, dof, THROUGH))
        pull = mul_t(turn, cross(along, arm))
        axis = mul_t(turn, along)
        moment = add(mul_t(bent, pull), cross(a, axis))
        own = _pairs(axis, alpha)
        first, second = _pairs(scaled(0.5, cross(axis, w)), r), _pairs(scaled(0.5, cross(axis, r)), w)
        for i in range(6):
            Y[dof, k + 4 + i] = own[i] + first[i] + second[i]
    Y[dof, k] = dot(pull, a)
    Y[dof, k + 1], Y[dof, k + 2], Y[dof, k + 3] = moment


@inner
def _pairs(p: Vec, q: Vec) -> Sym:
    """The factors of Jxx, Jxy, Jyy, Jxz, Jyz, Jzz in p . J q."""
    return (
        p[0] * q[0],
        p[0] * q[1] + p[1] * q[0],
        p[1] * q[1],
        p[0] * q[2] + p[2] * q[0],
        p[1] * q[2] + p[2] * q[1],
        p[2] * q[2],
    )


@inner
def _moment(parameters: Vector, k: int) -> Vec:
    return parameters[k + 1], parameters[k + 2], parameters[k + 3]


@inner
def _turned_by(parameters: Vector, k: int, w: Vec) -> Vec:
    """J w."""
    return (
        parameters[k + 4] * w[0] + parameters[k + 5] * w[1] + parameters[k + 7] * w[2],
        parameters[k + 5] * w[0] + parameters[k + 6] * w[1] + parameters[k + 8] * w[2],
        parameters[k + 7] * w[0] + parameters[k + 8] * w[1] + parameters[k + 9] * w[2],
    )
