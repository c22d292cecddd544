"""Typed robot files: every key is checked, unknown keys are refused, numbers are finite."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self, cast, get_args

import numpy as np
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    NonNegativeFloat,
    PositiveFloat,
    SerializerFunctionWrapHandler,
    ValidationError,
    model_serializer,
)
from pydantic_core import CoreSchema

from space_robot_description.frozen import READ_ONLY, frozen
from space_robot_description.validation import nearest, refusal
from space_robot_msgs_py.errors import NonFiniteError, SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.limits import TEXT_LENGTH, TITLE_LENGTH

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    # It has no public name.
    ModelMetaclass = type(BaseModel)

# ``title:`` with nothing behind it, and an empty parameter of a node, are no text, not a wrong one.
Title = Annotated[
    str, Field(max_length=TITLE_LENGTH.most), BeforeValidator(lambda value: "" if value is None else value)
]
Three = Annotated[tuple[float, ...], Field(min_length=3, max_length=3)]
PerJoint = float | tuple[float, ...] | dict[str, float]


# No quantity of a spacecraft in SI units is larger, and products of a few such numbers do not overflow.
MAX_MAGNITUDE = 1e15


def _hold_values(schema: Any) -> None:
    if isinstance(schema, list | tuple):
        for part in schema:
            _hold_values(part)
    elif isinstance(schema, dict):
        if schema.get("type") == "str":
            schema.setdefault("max_length", TEXT_LENGTH.most)
        if schema.get("type") in ("float", "int"):
            schema["strict"] = True
        if schema.get("type") == "float":
            if not schema.keys() & {"ge", "gt"}:
                schema["ge"] = -MAX_MAGNITUDE
            if not schema.keys() & {"le", "lt"}:
                schema["le"] = MAX_MAGNITUDE
        for part in list(schema.values()):
            _hold_values(part)


def _may_hold(annotation: Any) -> bool:
    """A dict or a list may be somewhere in such a value, outside of the models in it, which see to their own."""
    if annotation is Any or isinstance(annotation, str):
        return True
    origin = getattr(annotation, "__origin__", annotation)
    return origin in (dict, list) or any(_may_hold(part) for part in get_args(annotation))


class _ByHand(ModelMetaclass):
    """What makes a ``Strict``: one that is made by hand is refused in the words of a file's."""

    def __call__(cls, *args: Any, **kwargs: Any) -> Any:
        try:
            return super().__call__(*args, **kwargs)
        except ValidationError as error:
            name = cls.__qualname__.rpartition("<locals>.")[2]
            raise refusal(cast(type[BaseModel], cls), error, kwargs, f"{name}.") from None


class Strict(BaseModel, metaclass=_ByHand):
    """Base of every typed file: unknown keys, NaN, infinity and what is no number are errors.

    Values are immutable to the last dict and list inside: what was checked is what is run.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)
    # Names of the fields that may hold a dict or a list; the long ones, tables of numbers, are tuples of tuples.
    _holders: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        """Note once for all instances what has to be frozen."""
        super().__pydantic_init_subclass__(**kwargs)
        cls._holders = tuple(name for name, field in cls.model_fields.items() if _may_hold(field.annotation))

    def model_post_init(self, context: Any, /) -> None:
        """Freeze what pydantic's own ``frozen`` does not: the insides of the values."""
        for name in self._holders:
            self.__dict__[name] = frozen(self.__dict__[name])

    def __setattr__(self, name: str, value: Any) -> None:
        try:
            super().__setattr__(name, value)
        except ValidationError:
            raise AttributeError(f"{name}: {READ_ONLY}") from None

    def __delattr__(self, name: str) -> None:
        try:
            super().__delattr__(name)
        except ValidationError:
            raise AttributeError(f"{name}: {READ_ONLY}") from None

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy with some fields replaced, which are not checked, but as immutable as the others."""
        return super().model_copy(update={key: frozen(value) for key, value in (update or {}).items()}, deep=deep)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Hold every number of the model to being one: neither ``true`` nor ``"0.1"``, nor beyond ``MAX_MAGNITUDE``.

        A text that says nothing else has at most ``TEXT_LENGTH`` characters.
        """
        schema = handler(source)
        _hold_values(schema)
        return schema


class JointMotors(Strict):
    """Joint motors. ``PerJoint``: one number for all joints, a list in joint order, or a mapping by joint name."""

    effort: PerJoint = Field(
        default_factory=dict, description="effort limit [N m or N]; joints not named keep the URDF's limit"
    )
    lag: PerJoint = Field(default=0.0, description="first-order lag of the effort [s]; 0: immediate")
    viscous: PerJoint = Field(default=0.0, description="viscous friction [N m s/rad]")
    coulomb: PerJoint = Field(default=0.0, description="Coulomb friction [N m]")
    coulomb_velocity: PositiveFloat = Field(
        default=1e-3, description="rate at which Coulomb friction reaches tanh(1) of its value [rad/s]"
    )
    brake: PerJoint | None = Field(
        default=None, description="torque that the joint's brake can hold [N m or N]; 0 or null: it has none"
    )

    @model_serializer(mode="wrap")
    def _without_what_is_not(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # A robot without brakes is, to the byte, what it was before there were any.
        return {key: value for key, value in handler(self).items() if key != "brake" or value is not None}


class IdealTorque(Strict):
    """An external torque per body axis with a limit, no dynamics."""

    kind: Literal["ideal"] = "ideal"
    limit: Three = Field(description="torque limit per body axis [N m]")


class ReactionWheels(Strict):
    """Reaction wheels: they exchange angular momentum with the body and run out of it."""

    kind: Literal["reaction_wheels"] = "reaction_wheels"
    axes: tuple[Three, ...] = Field(
        default=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        min_length=3,
        description="spin axes in the body frame (normalised on load; they must span 3-D)",
    )
    torque: PositiveFloat = Field(description="torque limit of one wheel [N m]")
    momentum: PositiveFloat = Field(description="momentum limit of one wheel [N m s]")
    initial_momentum: tuple[float, ...] | None = Field(default=None, description="per wheel [N m s]; default 0")
    unloading: Three | None = Field(
        default=None, description="torque of thrusters that unload them, per body axis [N m]; null: there are none"
    )

    @model_serializer(mode="wrap")
    def _without_what_is_not(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # As with brakes: a robot without such thrusters is, to the byte, what it was before there were any.
        return {key: value for key, value in handler(self).items() if key != "unloading" or value is not None}


class Thrusters(Strict):
    """Force or torque per body axis by thrusters, proportional or pulsed."""

    kind: Literal["thrusters"] = "thrusters"
    limit: Three = Field(description="limit per body axis [N or N m]")
    pwm: bool = Field(default=False, description="full thrust for a part of the control period instead of a level")
    minimum_pulse: NonNegativeFloat = Field(default=0.0, description="shorter pulses are not fired [s], pwm only")


class Actuators(Strict):
    """What can push, and how hard."""

    saturation: Literal["per_axis", "direction_preserving"] = Field(
        default="per_axis", description="clip each channel, or scale the whole command until every channel fits"
    )
    joints: JointMotors
    base_torque: Annotated[IdealTorque | ReactionWheels | Thrusters, Field(discriminator="kind")]
    base_force: Thrusters | None = Field(default=None, description="required for free_flying, absent for free_floating")


def expand(
    values: PerJoint | Sequence[float], joint_names: Sequence[str], key: str, default: Sequence[float] | None = None
) -> Vector:
    """One number per joint from a scalar, a list in joint order, or a mapping by joint name.

    Args:
        values: what the file says.
        joint_names: the n joints in model order.
        key: dotted key for errors.
        default: (n,) values of the joints a mapping does not name; without it a mapping must name all.

    Returns:
        (n,) read-only array.

    Raises:
        SpecError: wrong count, unknown joint (with the nearest names) or missing joint.
        NonFiniteError: a NaN or infinity.
    """
    n = len(joint_names)
    if isinstance(values, dict):
        given = _by_name(values, joint_names, key, default)
    elif isinstance(values, int | float):
        given = [float(values)] * n
    else:
        given = [float(value) for value in values]
    if len(given) != n:
        raise SpecError(
            "wrong number of values", key=key, value=len(given), accepted=f"{n}, for {', '.join(joint_names)}"
        )
    out = np.array(given, dtype=np.float64)
    if not np.isfinite(out).all():
        raise NonFiniteError("not a finite number", key=key, value=out.tolist(), accepted="finite numbers")
    out.flags.writeable = False
    return out


def check_joint_names(names: Sequence[str], joint_names: Sequence[str], key: str) -> None:
    """Refuse a name that is no joint.

    Raises:
        SpecError: with the nearest names.
    """
    for name in names:
        if name not in joint_names:
            accepted = nearest(name, joint_names) or ", ".join(joint_names)
            raise SpecError("no such joint", key=key, value=name, accepted=accepted)


def _by_name(
    values: dict[str, float], joint_names: Sequence[str], key: str, default: Sequence[float] | None
) -> list[float]:
    check_joint_names(list(values), joint_names, key)
    if default is None and (missing := [name for name in joint_names if name not in values]):
        raise SpecError("a joint has no value", key=key, value=missing[0], accepted=f"all of {', '.join(joint_names)}")
    fallback = [0.0] * len(joint_names) if default is None else default
    return [float(values.get(name, other)) for name, other in zip(joint_names, fallback, strict=True)]
