"""What a dispersion can be, and one value out of it."""

from __future__ import annotations

from math import degrees, radians
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, NonNegativeFloat, model_validator

from space_robot_description.rotations import exp, to_rpy
from space_robot_description.spec import Strict
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import cos, power

Numbers = float | Annotated[tuple[float, ...], Field(min_length=1)]


def _sizes_fit(first: Numbers, second: Numbers) -> None:
    sizes = {len(part) for part in (first, second) if isinstance(part, tuple)}
    if len(sizes) > 1:
        raise ValueError("lists of different length")


class Uniform(Strict):
    """Uniform between two bounds; lists are drawn component by component."""

    low: Numbers = Field(description="in the unit of the key")
    high: Numbers = Field(description="in the unit of the key")

    @model_validator(mode="after")
    def _can_hold(self) -> Self:
        _sizes_fit(self.low, self.high)
        if np.any(np.greater(self.low, self.high)):
            raise ValueError("low must not be above high")
        return self


class Normal(Strict):
    """Normal; lists are drawn component by component, independently."""

    mean: Numbers = Field(description="in the unit of the key")
    std: Numbers = Field(description="standard deviation, in the unit of the key")

    @model_validator(mode="after")
    def _can_hold(self) -> Self:
        _sizes_fit(self.mean, self.std)
        if np.any(np.less(self.std, 0.0)):
            raise ValueError("std must not be negative")
        return self


class Direction(Strict):
    """A vector of three components in a uniformly random direction, its length uniform between two bounds."""

    low: NonNegativeFloat = Field(description="in the unit of the key")
    high: NonNegativeFloat = Field(description="in the unit of the key")

    @model_validator(mode="after")
    def _can_hold(self) -> Self:
        if self.low > self.high:
            raise ValueError("low must not be above high")
        return self


class Rotation(Strict):
    """A rotation out of all those by at most an angle, each as likely as any other; roll, pitch, yaw in degrees."""

    max_deg: float = Field(gt=0.0, le=180.0, description="180: any attitude [deg]")


class Draw(Strict):
    """How one key is dispersed: exactly one of these."""

    uniform: Uniform | None = None
    normal: Normal | None = None
    choice: tuple[Any, ...] | None = Field(default=None, min_length=1, description="one of these values")
    direction: Direction | None = None
    rotation: Rotation | None = None
    same_as: str | None = Field(default=None, description="the value drawn for this key")

    @model_validator(mode="after")
    def _one(self) -> Self:
        if len(self.model_fields_set) != 1 or None in (getattr(self, name) for name in self.model_fields_set):
            raise ValueError(f"exactly one of {', '.join(type(self).model_fields)}")
        return self

    def sample(self, rng: np.random.Generator) -> Any:
        """One value, as YAML could have said it; not of ``same_as``, whose value is another key's."""
        if self.uniform is not None:
            return _plain(rng.uniform(self.uniform.low, self.uniform.high))
        if self.normal is not None:
            return _plain(rng.normal(self.normal.mean, self.normal.std))
        if self.direction is not None:
            return (rng.uniform(self.direction.low, self.direction.high) * _direction(rng)).tolist()
        if self.rotation is not None:
            return _rotation(radians(self.rotation.max_deg), rng)
        values = self.choice or ()
        return values[int(rng.integers(len(values)))]


def _plain(drawn: float | Vector) -> float | list[float]:
    return np.asarray(drawn).tolist()  # type: ignore[no-any-return]


def _direction(rng: np.random.Generator) -> Vector:
    drawn = rng.standard_normal(3)
    return np.asarray(drawn / np.linalg.norm(drawn))


def _rotation(largest: float, rng: np.random.Generator) -> list[float]:
    """The density of the angle of a uniformly random rotation is 1 - cos(angle), at most angle^2 / 2."""
    axis = _direction(rng)
    while True:
        angle = largest * power(rng.uniform(), 1.0 / 3.0)
        if rng.uniform() * angle * angle / 2.0 <= 1.0 - cos(angle):
            return [degrees(part) for part in to_rpy(exp(angle * axis))]
