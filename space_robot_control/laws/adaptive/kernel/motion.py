"""Newton and Euler's recursion, polarised: the accelerations that M x_r'' + C(x, x') x_r' is made of.

The equations of motion in Lagrange's coordinates are quadratic in velocity with Christoffel's C, which is symmetric:
C(x, a) b = C(x, b) a. So C(x, x') x_r' is the symmetric bilinear form of the recursion's quadratic terms: every product
q(w, w) becomes (q(w, w_r) + q(w_r, w)) / 2. With x_r' = x' it is the ordinary recursion.

Reference: Slotine and Li, IJRR 6(3), 1987; Echeandia and Wensing, J. Computational and Nonlinear Dynamics 16(9), 2021.
"""

from __future__ import annotations

from space_robot_control.laws.adaptive.kernel.tree import ALONG, BASE, PLACE, Places, Tree
from space_robot_description.kernel.coupling import RATE, to_joints
from space_robot_description.kernel.jit import constants, inner
from space_robot_description.kernel.spatial import Vec, add, cross, get3, put3, scaled, sub
from space_robot_msgs_py.interfaces import Vector

# Columns of `Places.bodies`: angular velocity, reference angular velocity, angular acceleration, and acceleration of
# the body's origin, each (3,) in inertial axes.
OMEGA, OMEGA_R, ALPHA, ACCELERATION = constants(12, 15, 18, 21)

Spin = tuple[Vec, Vec, Vec]  # omega, omega_r, alpha


@inner
def move(tree: Tree, dx: Vector, dx_r: Vector, ddx_r: Vector, at: Places) -> None:
    """Give every placed body the motion of x' (6+n,), x_r' and x_r''."""
    if tree.coupling.shape[0]:
        to_joints(tree.coupling, dx, RATE, at.joints[1])
        to_joints(tree.coupling, dx_r, RATE, at.joints[2])
        to_joints(tree.coupling, ddx_r, RATE, at.joints[3])
        _move(tree, at.joints[1], at.joints[2], at.joints[3], at)
    else:
        _move(tree, dx, dx_r, ddx_r, at)


@inner
def _move(tree: Tree, dx: Vector, dx_r: Vector, ddx_r: Vector, at: Places) -> None:
    """The same of all joints (6+N,)."""
    bodies, axes = at.bodies, at.axes
    rest = (0.0, 0.0, 0.0)
    spin = (rest, rest, rest)
    for dof in range(3, BASE):
        spin = _spun(spin, get3(axes, dof, ALONG), dx[dof], dx_r[dof], ddx_r[dof])
    _keep(bodies, 0, spin, (ddx_r[0], ddx_r[1], ddx_r[2]))
    for body in range(1, tree.parent.shape[0]):
        above, dof = tree.parent[body], BASE + body - 1
        spin = (get3(bodies, above, OMEGA), get3(bodies, above, OMEGA_R), get3(bodies, above, ALPHA))
        arm = sub(get3(bodies, body, PLACE), get3(bodies, above, PLACE))
        acceleration = add(get3(bodies, above, ACCELERATION), _carried(spin, arm))
        along = get3(axes, dof, ALONG)
        if tree.slides[dof]:
            acceleration = add(acceleration, _slid(spin, along, dx[dof], dx_r[dof], ddx_r[dof]))
        else:
            spin = _spun(spin, along, dx[dof], dx_r[dof], ddx_r[dof])
        _keep(bodies, body, spin, acceleration)


@inner
def accelerate(push: Vec, at: Places) -> None:
    """Add an acceleration, inertial axes, to every body: that of a base that is pushed and does not turn."""
    for body in range(at.bodies.shape[0]):
        put3(at.bodies, body, ACCELERATION, add(get3(at.bodies, body, ACCELERATION), push))


@inner
def _keep(bodies: Vector, body: int, spin: Spin, acceleration: Vec) -> None:
    put3(bodies, body, OMEGA, spin[0])
    put3(bodies, body, OMEGA_R, spin[1])
    put3(bodies, body, ALPHA, spin[2])
    put3(bodies, body, ACCELERATION, acceleration)


@inner
def _spun(spin: Spin, along: Vec, rate: float, rate_r: float, acceleration: float) -> Spin:
    """Beyond a revolute degree of freedom."""
    omega, omega_r, alpha = spin
    turned = cross(add(scaled(0.5 * rate_r, omega), scaled(0.5 * rate, omega_r)), along)
    return (
        add(omega, scaled(rate, along)),
        add(omega_r, scaled(rate_r, along)),
        add(alpha, add(scaled(acceleration, along), turned)),
    )


@inner
def _carried(spin: Spin, arm: Vec) -> Vec:
    """Acceleration of a point at an arm, relative to that of the origin."""
    omega, omega_r, alpha = spin
    both = add(cross(omega, cross(omega_r, arm)), cross(omega_r, cross(omega, arm)))
    return add(cross(alpha, arm), scaled(0.5, both))


@inner
def _slid(spin: Spin, along: Vec, rate: float, rate_r: float, acceleration: float) -> Vec:
    """What sliding adds to the acceleration."""
    omega, omega_r, _ = spin
    return add(scaled(acceleration, along), cross(add(scaled(rate_r, omega), scaled(rate, omega_r)), along))
