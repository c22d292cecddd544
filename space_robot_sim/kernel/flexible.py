"""Springs and dampers of a plant: joints that no motor drives, and gears that twist between motor and link.

A row per coordinate of the tree. Without rotor the spring pulls the coordinate back to zero: e = -k x - d x'. With one
it is between motor and link, and the motor has an angle of its own, as seen behind the gear:

    B theta'' = tau - k (theta - q) - d (theta' - q'),    the link feels k (theta - q) + d (theta' - q')

Reference: Spong (1987), "Modeling and control of elastic joint robots", J. Dyn. Syst. Meas. Control 109(4), (15)-(16):
the rotor's energy is that of its own turning alone, so momentum is that of the links.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.jit import constants, inner
from space_robot_msgs_py.interfaces import Vector

# Columns: stiffness, damping, inertia of the rotor behind the gear (0: there is none), where its angle and its rate
# stand in the state.
STIFFNESS, DAMPING, ROTOR, ANGLE, SPEED, SPRING_SIZE = constants(0, 1, 2, 3, 4, 5)
RIGID: npt.NDArray[np.float64] = np.zeros((0, 5))


@inner
def driven_rate(springs: Vector, y: Vector, joint: int, rate: float) -> float:
    """The rate at which a motor turns behind its gear; ``rate`` of the link where the gear is rigid."""
    if springs.shape[0] and springs[joint, ROTOR] > 0.0:
        rate = y[int(springs[joint, SPEED])]
    return rate


@inner
def spring_efforts(springs: Vector, y: Vector, effort: Vector, dy: Vector) -> float:
    """Turn efforts of motors (n,) into efforts on links and write dy/dt of the motors; returns the power lost [W]."""
    n, lost = effort.shape[0], 0.0
    for joint in range(n):
        stiffness, damping, rotor = springs[joint, STIFFNESS], springs[joint, DAMPING], springs[joint, ROTOR]
        if stiffness > 0.0:
            twist, rate = -y[7 + joint], -y[13 + n + joint]
            if rotor > 0.0:
                angle, speed = int(springs[joint, ANGLE]), int(springs[joint, SPEED])
                twist, rate = twist + y[angle], rate + y[speed]
            given = stiffness * twist + damping * rate
            if rotor > 0.0:
                dy[angle], dy[speed] = y[speed], (effort[joint] - given) / rotor
                effort[joint] = given
            else:
                effort[joint] += given
            lost += damping * rate * rate
    dy[20 + 2 * n] = lost
    return lost


@inner
def stored_energy(springs: Vector, y: Vector) -> float:
    """What springs hold, and the kinetic energy of rotors [J]."""
    total = 0.0
    for joint in range(springs.shape[0]):
        twist, rotor = y[7 + joint], springs[joint, ROTOR]
        if rotor > 0.0:
            speed = y[int(springs[joint, SPEED])]
            twist -= y[int(springs[joint, ANGLE])]
            total += 0.5 * rotor * speed * speed
        total += 0.5 * springs[joint, STIFFNESS] * twist * twist
    return total
