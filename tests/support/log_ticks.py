"""Ticks of random numbers for a small robot whose names need care in patterns."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from space_robot_msgs_py.interfaces import Command, ControlOutput, PlantSample, Reference, RobotState, Telemetry, Tick

NAMES = ("first", "100%s")
URDF = """<robot name="r"><link name="base_link"/><link name="a"/><link name="b"/>
<joint name="first" type="revolute"><parent link="base_link"/><child link="a"/><axis xyz="0 0 1"/></joint>
<joint name="100%s" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/></joint></robot>"""


def tick_of(index: int, *, labels: tuple[str, ...] = ("x%", "y"), joints: int = 2, **more: Any) -> Tick:
    """A tick of random numbers."""
    rng, stamp = np.random.default_rng(index), 100_000_000 * index
    q, v = rng.normal(size=7 + joints), rng.normal(size=6 + joints)
    telemetry = Telemetry.of(stamp, {label: rng.normal(size=3) for label in labels})
    sample = PlantSample(RobotState(stamp, q, v, rng.normal(size=joints), rng.normal(size=3)), telemetry)
    output = ControlOutput(Command(stamp, rng.normal(size=6), rng.normal(size=joints)), telemetry)
    return Tick(sample, Reference(stamp, -q, -v, 2.0 * v), replace(output, **more))
