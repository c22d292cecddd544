"""The robot file: which URDF, on which satellite, pushed by what."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, PositiveFloat, SerializerFunctionWrapHandler, model_serializer

from space_robot_description.spec import Actuators, PerJoint, Strict, Three
from space_robot_msgs_py.bounded_files import short
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.limits import NAME_LENGTH, URDF_BYTES

ArmName = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=NAME_LENGTH.most)]
INERTIA_KEYS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


class InertiaEntries(Strict):
    """Inertia tensor entries by name, as URDF names them."""

    ixx: float
    iyy: float
    izz: float
    ixy: float = 0.0
    ixz: float = 0.0
    iyz: float = 0.0


InertiaInput = tuple[float, ...] | InertiaEntries


class Pose(Strict):
    """Where a frame stands in its parent."""

    xyz: Three = Field(default=(0.0, 0.0, 0.0), description="origin [m]")
    rpy: Three = Field(default=(0.0, 0.0, 0.0), description="fixed-axis roll, pitch, yaw, R = Rz Ry Rx [rad]")


class BaseSpec(Strict):
    """The satellite under a fixed-base arm; frame ``base_link``."""

    mass: float = Field(description="[kg]")
    inertia: InertiaInput = Field(
        description="about the centre of mass, base axes [kg m2]: [Ixx, Iyy, Izz], or those and Ixy, Ixz, Iyz "
        "(tensor entries, as in URDF), or a mapping ixx..iyz"
    )
    com: Three = Field(default=(0.0, 0.0, 0.0), description="centre of mass in base_link [m]")
    mount: Pose = Field(default_factory=Pose, description="the arm's root link in base_link")
    size: Three | None = Field(
        default=None,
        description="box to draw, centred on base_link [m]; default: the homogeneous box of this mass and inertia",
    )


class ArmSpec(Strict):
    """One of several arms on the satellite. Its names are those of its own URDF."""

    urdf: str = Field(min_length=1, max_length=URDF_BYTES.most, description="as that of a robot")
    xacro_args: dict[str, bool | int | float | str] = Field(
        default_factory=dict, description="arguments of a xacro file by name"
    )
    mount: Pose = Field(default_factory=Pose, description="its root link in base_link")
    tool: str | None = Field(
        default=None, description="link at its end; default: link `tool`, else the end of the longest chain"
    )


class JointLimits(Strict):
    """Limits that override the URDF's."""

    lower: float | None = Field(default=None, description="[rad or m]")
    upper: float | None = Field(default=None, description="[rad or m]")
    velocity: PositiveFloat | None = Field(default=None, description="[rad/s or m/s]")


class InertiaChanges(Strict):
    """Inertias of links that are not those of the URDF."""

    project: tuple[str, ...] = Field(
        default=(), description="links of which the inertia cannot exist: they get the nearest one that can"
    )
    replace: dict[str, InertiaInput] = Field(
        default_factory=dict,
        description="link: inertia about its centre of mass, axes of the link [kg m2], as that of base",
    )


class RobotSpec(Strict):
    """A robot file. Joint and link names are those of the composed URDF."""

    name: str = Field(min_length=1, max_length=NAME_LENGTH.most)
    description: str = ""
    urdf: str = Field(
        default="",
        max_length=URDF_BYTES.most,
        description="path relative to this file, package://<package>/<path>, example-robot-data:<path under robots/>, "
        "or the URDF text itself; FILE.xacro is expanded where the extra `xacro` is installed",
    )
    xacro_args: dict[str, bool | int | float | str] = Field(
        default_factory=dict, description="arguments of a xacro file by name"
    )
    arms: dict[ArmName, ArmSpec] = Field(
        default_factory=dict,
        description="several arms on the satellite `base`, in place of `urdf`: name -> arm; its links and joints get "
        "the name and an underscore in front",
    )
    base: BaseSpec | None = Field(
        default=None, description="present: the URDF is an arm and stands on this satellite; absent: it is everything"
    )
    base_mode: Literal["free_floating", "free_flying"] = Field(
        description="free_floating: no force on the base; free_flying: thrusters push it"
    )
    actuators: Actuators
    home: PerJoint = Field(
        default_factory=dict, description="[rad or m]; joints not named stand at 0, or at the limit nearest to it"
    )
    locked_joints: dict[str, float] = Field(default_factory=dict, description="joint: position it is fixed at")
    joint_limits: dict[str, JointLimits] = Field(
        default_factory=dict, description="joint: limits instead of the URDF's"
    )
    inertia: InertiaChanges = Field(
        default_factory=InertiaChanges, description="inertias that replace the URDF's; names of links as composed"
    )
    tool: str | None = Field(
        default=None,
        description="link at the end of the arm; default: link `tool`, else the end of the longest chain; of several "
        "arms that of the first",
    )
    tools: dict[ArmName, str] = Field(
        default_factory=dict, description="more links that are tools, by a name for references and payloads"
    )

    @model_serializer(mode="wrap")
    def _without_what_is_not(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # A robot of one arm is, to the byte, what it was before there were several.
        return {key: value for key, value in handler(self).items() if key not in ("arms", "tools") or value}


def check_sources(spec: RobotSpec) -> None:
    """Refuse a robot without a URDF, or with arms that have nothing to stand on.

    Raises:
        SpecError: it names the key.
    """
    if not spec.urdf and not spec.arms:
        raise SpecError("missing", key="urdf", accepted="a URDF, or arms: {left: {urdf: ...}, ...} on a base")
    if spec.urdf and spec.arms:
        raise SpecError("arms have URDFs of their own", key="urdf", value=short(spec.urdf), accepted="urdf or arms")
    if spec.arms and spec.base is None:
        raise SpecError("missing", key="base", accepted="the satellite on which the arms stand: {mass, inertia}")
    if spec.arms and spec.base is not None and spec.base.mount != Pose():
        value, accepted = list(spec.base.mount.xyz), "arms.NAME.mount, of each arm"
        raise SpecError("is of a single arm", key="base.mount", value=value, accepted=accepted)


def tensor(entries: InertiaInput, key: str) -> Vector:
    """The (3, 3) tensor of an inertia given in a file.

    Raises:
        SpecError: the list has neither 3 nor 6 numbers.
    """
    values = [getattr(entries, name) for name in INERTIA_KEYS] if isinstance(entries, InertiaEntries) else list(entries)
    if len(values) not in (3, 6):
        raise SpecError(
            "wrong number of values", key=key, value=values, accepted="3 (Ixx, Iyy, Izz) or 6 (+ Ixy, Ixz, Iyz)"
        )
    ixx, iyy, izz, ixy, ixz, iyz = values + [0.0] * (6 - len(values))
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
