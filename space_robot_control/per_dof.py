"""One gain per degree of freedom, as it stands in files."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import Field, NonNegativeFloat, model_validator

from space_robot_description.robot import Robot
from space_robot_description.spec import Strict, expand
from space_robot_msgs_py.interfaces import Vector

PARTS = ("translation", "rotation", "joints")
Axes = NonNegativeFloat | Annotated[tuple[NonNegativeFloat, ...], Field(min_length=3, max_length=3)]
Joints = NonNegativeFloat | tuple[NonNegativeFloat, ...] | dict[str, NonNegativeFloat]


class OneForAll(Strict):
    """A section of translation, rotation and joints in whose place one number may stand."""

    @model_validator(mode="before")
    @classmethod
    def _one_for_all(cls, data: Any) -> Any:
        if isinstance(data, (int, float)) and not isinstance(data, bool):
            return dict.fromkeys(PARTS, data)
        return data


class PerDof(OneForAll):
    """Base translation, base rotation and joints.

    Subclasses state the unit and give the three fields their defaults.
    """

    translation: Axes
    rotation: Axes
    joints: Joints

    def values(self, robot: Robot, key: str) -> Vector:
        """Return (6+n,) numbers: translation, rotation, joints.

        Raises:
            SpecError: the joints are not the robot's; the message starts with ``key``.
        """
        out = np.empty(6 + robot.n)
        out[:3], out[3:6] = self.translation, self.rotation
        out[6:] = expand(self.joints, robot.joint_names, f"{key}.joints")
        return out
