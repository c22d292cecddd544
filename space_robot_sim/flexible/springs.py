"""Columns of a table of springs, apart from the kernel that works with them: checking a file compiles nothing.

A row per coordinate: stiffness [N m/rad or N/m], damping [N m s/rad or N s/m], inertia of the rotor behind its gear
[kg m2 or kg] (0: the spring is not of a gear), where the rotor's angle and its rate stand in the state.
"""

from __future__ import annotations

STIFFNESS, DAMPING, ROTOR, ANGLE, SPEED, SPRING_SIZE = range(6)
