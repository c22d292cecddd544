"""The same robot with other numbers: seeded random deviations of inertials, motor and base actuators."""

from __future__ import annotations

import dataclasses
from typing import Any, Literal

import numpy as np
import pinocchio as pin
from pydantic import Field, NonNegativeFloat, model_validator

from space_robot_description.inertia import inertial_parameters, is_consistent
from space_robot_description.robot import Robot
from space_robot_description.spec import Actuators, IdealTorque, ReactionWheels, Strict, Thrusters
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import InertiaError, SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import dot

# Orders are part of the result: draws happen body by body, quantity by quantity, whatever the order in the file.
BODY_QUANTITIES = ("mass", "com", "inertia", "parameters")
# Not a key of a file: absolute deviations of the ten parameters, see ``eta_is``.
VARIANCE = "variance"
JOINT_QUANTITIES = ("effort", "lag", "viscous", "coulomb")
BASE_QUANTITIES = ("base_torque.torque", "base_torque.momentum", "base_torque.limit", "base_force.limit")
MAX_DRAWS = 1000


class Spread(Strict):
    """How far a value deviates, relative to itself; exactly one of the two."""

    normal: NonNegativeFloat | None = Field(default=None, description="standard deviation / value [-]")
    uniform: NonNegativeFloat | None = Field(default=None, description="half width / value [-]")

    @model_validator(mode="after")
    def _one(self) -> Spread:
        if (self.normal is None) == (self.uniform is None):
            raise ValueError("exactly one of normal and uniform")
        return self

    def draw(self, rng: np.random.Generator, size: int) -> Vector:
        """(size,) factors around 1."""
        if self.normal is not None:
            return 1.0 + self.normal * rng.standard_normal(size)
        return 1.0 + float(self.uniform or 0.0) * rng.uniform(-1.0, 1.0, size)


class Dispersion(Strict):
    """Which parameters are perturbed and how far.

    Keys of ``parameters``, with a body, joint or ``*`` in the middle (a name wins over ``*``):

    - ``bodies.<body>.mass``: the mass, with the inertia scaled alike (density); ``.com``: each coordinate;
      ``.inertia``: each tensor entry about the centre of mass; ``.parameters``: each of the ten parameters
      [m, m c, I about the joint origin] by itself, the way `eta` does.
    - ``joints.<joint>.effort`` | ``lag`` | ``viscous`` | ``coulomb``; factors are clipped at 0.01.
    - ``base_torque.torque`` | ``momentum`` (wheels), ``base_torque.limit``, ``base_force.limit`` (per axis).
    """

    parameters: dict[str, NonNegativeFloat | Spread] = Field(
        default_factory=dict, description="key: standard deviation / value, or {normal: x}, or {uniform: x}"
    )
    eta: NonNegativeFloat = Field(
        default=0.0,
        description="every inertial parameter pi of every body ~ N(pi, (eta pi / 3)^2): Liu et al. (2023), (46)",
    )
    eta_is: Literal["std", "variance"] = Field(
        default="std",
        description="eta abs(pi) / 3 in (46) is the standard deviation, as the sentence beside it says, or the "
        "variance in SI units, as it is printed",
    )
    inconsistent: Literal["reject", "keep"] = Field(
        default="reject",
        description="a draw that cannot exist as a body is drawn again, or kept: only for a controller's prior, "
        "a plant with such a body may have no finite acceleration",
    )


def disperse(robot: Robot, dispersion: Dispersion, rng: np.random.Generator) -> Robot:
    """Draw one robot around the given one.

    Args:
        robot: it is not changed.
        dispersion: what is perturbed.
        rng: the only source of chance; the same state gives the same bits.

    Returns:
        A robot with a model of its own.

    Raises:
        SpecError: a key names nothing of this robot (with the nearest keys).
        InertiaError: no consistent body in 1000 draws; the message names the body.
    """
    spreads = _spreads(robot, dispersion)
    model = robot.model.copy()
    before = inertial_parameters(robot)
    for index, body in enumerate(robot.body_names):
        names = ((quantity, f"bodies.{body}.{quantity}") for quantity in (*BODY_QUANTITIES, VARIANCE))
        chosen = {quantity: spreads[name] for quantity, name in names if name in spreads}
        # What has no mass has nothing to deviate.
        if chosen and before[index, 0] > 0.0:
            drawn = _draw_body(body, before[index], chosen, dispersion.inconsistent, rng)
            model.inertias[index + 1] = pin.Inertia.FromDynamicParameters(drawn)
    actuators = _disperse_actuators(robot, spreads, rng)
    effort = np.array(actuators.joints.effort) if _strays(spreads, "joints.", ".effort") else robot.effort_limit
    effort.flags.writeable = False
    return dataclasses.replace(robot, model=model, actuators=actuators, effort_limit=effort)


def _spreads(robot: Robot, dispersion: Dispersion) -> dict[str, Spread]:
    valid = [f"bodies.{name}.{q}" for name in ("*", *robot.body_names) for q in BODY_QUANTITIES]
    valid += [f"joints.{name}.{q}" for name in ("*", *robot.joint_names) for q in JOINT_QUANTITIES]
    valid += _base_keys(robot.actuators)
    out: dict[str, Spread] = {}
    if dispersion.eta > 0.0:
        quantity = "parameters" if dispersion.eta_is == "std" else VARIANCE
        out |= {f"bodies.{name}.{quantity}": Spread(normal=dispersion.eta / 3.0) for name in robot.body_names}
    for key, value in sorted(dispersion.parameters.items(), key=lambda item: "*" not in item[0]):
        if key not in valid:
            accepted = nearest(key, valid) or ", ".join(valid[:8])
            raise SpecError("nothing to disperse has this name", key=f"dispersion.{key}", accepted=accepted)
        spread = value if isinstance(value, Spread) else Spread(normal=value)
        group, star, quantity = key.partition(".*.")
        names = robot.body_names if group == "bodies" else robot.joint_names
        out |= {f"{group}.{name}.{quantity}": spread for name in names} if star else {key: spread}
    return out


def _base_keys(actuators: Actuators) -> list[str]:
    wheels = isinstance(actuators.base_torque, ReactionWheels)
    keys = ["base_torque.torque", "base_torque.momentum"] if wheels else ["base_torque.limit"]
    return keys if actuators.base_force is None else [*keys, "base_force.limit"]


def _strays(spreads: dict[str, Spread], start: str, end: str) -> bool:
    return any(key.startswith(start) and key.endswith(end) for key in spreads)


def _draw_body(
    body: str, nominal: Vector, chosen: dict[str, Spread], inconsistent: str, rng: np.random.Generator
) -> Vector:
    limit = not is_consistent(nominal)
    for _ in range(MAX_DRAWS):
        drawn = _draw_parameters(nominal, chosen, rng)
        if inconsistent == "keep" and drawn[0] != 0.0:
            return drawn
        if is_consistent(drawn, limit=limit):
            return drawn
    raise InertiaError(
        f"no physically consistent body in {MAX_DRAWS} draws",
        key=f"link {body}",
        value=", ".join(f"{quantity} {spread.normal or spread.uniform}" for quantity, spread in chosen.items()),
        accepted="a smaller dispersion, or inconsistent: keep for a controller's prior",
    )


def _draw_parameters(nominal: Vector, chosen: dict[str, Spread], rng: np.random.Generator) -> Vector:
    body = pin.Inertia.FromDynamicParameters(nominal)
    mass, com, inertia = body.mass, body.lever.copy(), body.inertia.copy()
    if "mass" in chosen:
        factor = float(chosen["mass"].draw(rng, 1)[0])
        mass, inertia = mass * factor, inertia * factor
    if "com" in chosen:
        com = com * chosen["com"].draw(rng, 3)
    if "inertia" in chosen:
        upper = np.triu(np.ones((3, 3), dtype=bool))
        factors = np.zeros((3, 3))
        factors[upper] = chosen["inertia"].draw(rng, 6)
        inertia = inertia * (factors + np.triu(factors, 1).T)
    drawn = nominal if chosen.keys() <= {"parameters", VARIANCE} else _parameters(mass, com, inertia)
    if VARIANCE in chosen:
        deviation = np.sqrt(float(chosen[VARIANCE].normal or 0.0) * np.abs(nominal))
        drawn = drawn + deviation * rng.standard_normal(10)
    return drawn * chosen["parameters"].draw(rng, 10) if "parameters" in chosen else drawn


def _parameters(mass: float, com: Vector, inertia: Vector) -> Vector:
    """Ten parameters without `pin.Inertia`, whose constructor refuses what `keep` must let pass."""
    about_origin = inertia + mass * (dot(com, com) * np.eye(3) - np.outer(com, com))
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = about_origin
    return np.array([mass, *(mass * com), ixx, ixy, iyy, ixz, iyz, izz])


def _disperse_actuators(robot: Robot, spreads: dict[str, Spread], rng: np.random.Generator) -> Actuators:
    actuators = robot.actuators
    motors: dict[str, Any] = {}
    for quantity in JOINT_QUANTITIES:
        keys = [f"joints.{name}.{quantity}" for name in robot.joint_names]
        if any(key in spreads for key in keys):
            values = _per_joint(actuators, quantity, robot.n)
            factors = [_factor(spreads[key], rng, 1)[0] if key in spreads else 1.0 for key in keys]
            motors[quantity] = tuple(value * float(factor) for value, factor in zip(values, factors, strict=True))
    update: dict[str, Any] = {"joints": actuators.joints.model_copy(update=motors)}
    for key in BASE_QUANTITIES:
        if key in spreads:
            section, field = key.split(".")
            update[section] = _scaled(update.get(section, getattr(actuators, section)), field, spreads[key], rng)
    return actuators.model_copy(update=update)


def _per_joint(actuators: Actuators, quantity: str, n: int) -> tuple[float, ...]:
    values = getattr(actuators.joints, quantity)
    return values if isinstance(values, tuple) else (float(values),) * n


def _scaled(
    part: IdealTorque | ReactionWheels | Thrusters, field: str, spread: Spread, rng: np.random.Generator
) -> IdealTorque | ReactionWheels | Thrusters:
    value = getattr(part, field)
    factors = _factor(spread, rng, np.size(value)).tolist()
    scaled = (
        tuple(v * f for v, f in zip(value, factors, strict=True)) if isinstance(value, tuple) else value * factors[0]
    )
    return part.model_copy(update={field: scaled})


def _factor(spread: Spread, rng: np.random.Generator, size: int) -> Vector:
    """A limit or a friction has no sign to lose."""
    return np.maximum(spread.draw(rng, size), 0.01)
