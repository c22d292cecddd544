"""Which machine code a kernel is called by: that of the types of its arguments, however often it was asked for."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from space_robot_description.kernel import jit
from space_robot_msgs_py.interfaces import Vector

pytestmark = pytest.mark.skipif(not jit.MACHINE_CODE, reason="nothing is compiled")


class Pair(NamedTuple):
    """Two arrays."""

    one: Vector
    other: Vector


class Couple(NamedTuple):
    """Two arrays under another name."""

    one: Vector
    other: Vector


def _frozen(values: Vector) -> Vector:
    values.setflags(write=False)
    return values


DIFFERENT = {
    "float": 1.0,
    "int": 1,
    "bool": True,
    "int64": np.int64(1),
    "float32": np.float32(1),
    "vector": np.zeros(3),
    "read-only": _frozen(np.zeros(3)),
    "strided": np.zeros(6)[::2],
    "matrix": np.zeros((3, 3)),
    "by columns": np.zeros((3, 3), order="F"),
    "integers": np.zeros(3, dtype=np.int64),
    "pair": Pair(np.zeros(3), np.zeros(3)),
    "couple": Couple(np.zeros(3), np.zeros(3)),
    "half frozen": Pair(np.zeros(3), _frozen(np.zeros(3))),
    "plain": (np.zeros(3), np.zeros(3)),
}


def test_arguments_share_machine_code_only_if_numba_has_one_type_for_both() -> None:
    """Arrays, numbers and tuples of all kinds; values and lengths make no difference."""
    import numba

    known = {name: jit.type_key(value) for name, value in DIFFERENT.items()}
    types = {name: numba.typeof(value) for name, value in DIFFERENT.items()}
    for one in DIFFERENT:
        for other in DIFFERENT:
            if known[one] == known[other]:
                assert types[one] == types[other], (one, other)
    assert jit.type_key(Pair(np.ones(5), np.ones(7))) == known["pair"]


def test_a_kernel_is_ready_for_every_type_it_was_made_ready_for() -> None:
    """Asked again for the first types, it gives the code of those, not of the last ones."""

    def first_of(values: Vector) -> float:
        return 2.0 * values[0]

    kernel = jit.kernel(first_of)
    arguments = np.full(2, 1.5), np.full(2, 2, dtype=np.int64)
    for values in (*arguments, *arguments):
        assert jit.bound(kernel, values)(values) == 2.0 * float(values[0])
    assert len(kernel.signatures) == 2  # type: ignore[attr-defined]
