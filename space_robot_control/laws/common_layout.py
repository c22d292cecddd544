"""Telemetry of several laws in one layout, of which one answers at a time."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import accumulate
from typing import Any

import numpy as np

from space_robot_control.laws.base import Blocks
from space_robot_control.tracking import ERROR_FIELDS, tracking_errors
from space_robot_msgs_py.interfaces import Reference, RobotState, Telemetry, Vector

ACTIVE = "active_law"
HANDOVER = "handover"


class CommonLayout:
    """Where the numbers of each law go among those of all.

    Args:
        telemetry: of each law, by name.
        own: names of the laws whose telemetry has the errors in the terms of ``ERROR_FIELDS``.
        n: number of joints.
        marks: labels of single numbers beside.
    """

    def __init__(
        self, telemetry: Mapping[str, Telemetry], own: Collection[str], n: int, marks: Sequence[str] = ()
    ) -> None:
        errors = dict(zip(ERROR_FIELDS, (3, 3, n, 6, n), strict=True))
        blocks = errors | {ACTIVE: 1, HANDOVER: 1} | dict.fromkeys(marks, 1)
        for name, one in telemetry.items():
            blocks |= {f"{name}.{label}": size for label, size in _sizes(one).items() if label not in errors}
        self.labels, self.sizes = tuple(blocks), tuple(blocks.values())
        places, self._switch = _places(blocks), 12 + 2 * n
        self._nothing = np.zeros(sum(self.sizes))
        self._rows: dict[str, tuple[int, list[tuple[str, int, int, slice]], bool]] = {}
        for index, (name, one) in enumerate(telemetry.items()):
            rows = []
            for label, size in _sizes(one).items():
                shared = label in errors
                if not shared or name in own:
                    place = places[label if shared else f"{name}.{label}"]
                    rows.append((label, size, place.start, place))
            self._rows[name] = index, rows, name in own
        self._counts = {name: len(one.labels) for name, one in telemetry.items()}

    def of(self, name: str, own: Blocks, state: RobotState, reference: Reference, marks: Sequence[float]) -> Telemetry:
        """All telemetry of a state, of which all but the errors is 0 for the laws that are idle.

        Args:
            name: of the active law.
            own: its telemetry.
            state: that it answered.
            reference: that it followed.
            marks: weight of the handover, then those that this layout was made with.

        Raises:
            NonFiniteError: a number is not finite.
            ValueError: the blocks are not those of the first answer.
        """
        index, rows, has_errors = self._rows[name]
        if len(own) != self._counts[name]:
            raise ValueError("other blocks than before")
        data = self._nothing.copy()
        for label, size, start, place in rows:
            block: Any = own.get(label)
            if isinstance(block, np.ndarray) and block.size == size:
                data[place] = block
            elif size == 1 and isinstance(block, float):
                data[start] = block
            else:
                data[place] = _checked(block, size)
        if not has_errors:
            errors, split = tracking_errors(state, reference), self._switch // 2
            data[:split], data[split : self._switch] = errors.configuration, errors.velocity
        data[self._switch], data[self._switch + 1] = index, marks[0]
        if len(marks) > 1:
            data[self._switch + 2 : self._switch + 1 + len(marks)] = marks[1:]
        return Telemetry(state.stamp, self.labels, self.sizes, data)


def _sizes(telemetry: Telemetry) -> dict[str, int]:
    return dict(zip(telemetry.labels, telemetry.sizes, strict=True))


def _places(sizes: Mapping[str, int]) -> dict[str, slice]:
    """Where the numbers of each block stand."""
    ends = list(accumulate(sizes.values(), initial=0))
    return {label: slice(start, start + size) for (label, size), start in zip(sizes.items(), ends, strict=False)}


def _checked(block: Any, size: int) -> Vector:
    found: Vector = np.asarray([] if block is None else block, dtype=np.float64).reshape(-1)
    if found.size != size:
        raise ValueError("another size than before")
    return found
