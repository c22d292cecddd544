"""The mass matrix of a model, symmetric; where speed counts laws and plant have ways of their own."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_msgs_py.interfaces import Vector


def mass_matrix(model: Any, q: Vector) -> Vector:
    """Return M(q) (6+n, 6+n) [kg, kg m, kg m2].

    Args:
        model: ``pin.Model`` of a robot.
        q: (7+n,) configuration [m, -, rad or m].
    """
    upper = np.triu(pin.crba(model, model.createData(), q))
    full: Vector = upper + np.triu(upper, 1).T
    return full
