"""Numbers that pass a boundary: read-only, finite, of the right size."""

from __future__ import annotations

from math import isfinite

import numpy as np
import numpy.typing as npt

from space_robot_msgs_py.errors import CommandError, NonFiniteError

Vector = npt.NDArray[np.float64]
_FLOAT64 = np.dtype(np.float64)


def vector(values: npt.ArrayLike, size: int | None, key: str) -> Vector:
    """Return a read-only, finite float64 array of shape (size,): a copy, or the array itself if it lies on bytes.

    Raises:
        CommandError: the shape is not (size,).
        NonFiniteError: an element is NaN or infinite.
    """
    # Bytes cannot change, so what a codec read from a message needs no copy.
    base: object = getattr(values, "base", None)
    if isinstance(base, bytes) and isinstance(values, np.ndarray) and values.dtype is _FLOAT64:
        out = values
    else:
        out = np.array(values, dtype=np.float64)
        out.setflags(write=False)
    if out.ndim != 1 or (size is not None and out.size != size):
        raise CommandError("wrong size", key=key, value=out.shape, accepted=f"a vector of {size} numbers")
    # A finite sum has finite terms; the converse fails where large numbers overflow. Python's floats take a third of
    # the time of arrays here, and do not warn about inf - inf.
    if not isfinite(sum(out.tolist())) and not np.isfinite(out).all():
        raise NonFiniteError("not a finite number", key=key, value=out.tolist(), accepted="finite numbers")
    return out
