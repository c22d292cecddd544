"""Numbers per joint as people write them (one for all, a list, a mapping by name) to one vector in model order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector


def joint_values(
    values: float | Sequence[float] | Mapping[str, float],
    names: Sequence[str],
    key: str,
    rest: npt.ArrayLike | None = None,
) -> Vector:
    """Expand per-joint numbers.

    Args:
        values: one number for all joints, a list in joint order, or a mapping by joint name.
        names: (n) joint names in model order.
        key: what to call the numbers in an error.
        rest: (n,) what a mapping does not name; None: a mapping has to name every joint.

    Returns:
        (n,) a new array in model order, unit as given.

    Raises:
        SpecError: wrong number of values, an unknown joint, or one left out.
    """
    if isinstance(values, Mapping):
        return _from_mapping(values, names, key, rest)
    if isinstance(values, (int, float)):
        return np.full(len(names), float(values))
    if len(values) != len(names):
        accepted = f"{len(names)} numbers, in the order {', '.join(names)}"
        raise SpecError("wrong number of values", key=key, value=list(values), accepted=accepted)
    return np.array(values, dtype=np.float64)


def _from_mapping(values: Mapping[str, float], names: Sequence[str], key: str, rest: npt.ArrayLike | None) -> Vector:
    for name in values:
        if name not in names:
            close = nearest(name, names)
            accepted = f"did you mean {close}?" if close else ", ".join(names)
            raise SpecError("no such joint", key=f"{key}.{name}", value=name, accepted=accepted)
    if rest is None:
        missing = [name for name in names if name not in values]
        if missing:
            raise SpecError("joints left out", key=key, value=missing, accepted="a number for every joint")
        return np.array([values[name] for name in names], dtype=np.float64)
    out = np.array(rest, dtype=np.float64)
    for index, name in enumerate(names):
        out[index] = values.get(name, out[index])
    return out
