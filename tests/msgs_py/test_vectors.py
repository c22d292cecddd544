import numpy as np
import pytest

from space_robot_msgs_py.errors import CommandError, NonFiniteError
from space_robot_msgs_py.vectors import vector

HUGE = 1.7e308


@pytest.mark.parametrize("bad", [[np.nan], [np.inf], [np.inf, -np.inf], [HUGE, HUGE, np.nan], [1.0, -np.inf, HUGE]])
def test_a_number_that_is_not_finite_never_passes(bad):
    """NaN and infinities are refused wherever they stand, from a list, an array or bytes, without a warning."""
    for values in (bad, np.array(bad), np.frombuffer(np.array(bad).tobytes())):
        with pytest.raises(NonFiniteError):
            vector(values, None, "x")


def test_large_finite_numbers_pass():
    """Numbers whose sum overflows are finite all the same, and raise no warning."""
    assert vector([HUGE, HUGE, HUGE], 3, "x").tolist() == [HUGE] * 3


@pytest.mark.parametrize("source", [np.arange(3.0), np.arange(6.0)[::2], np.arange(3), np.arange(3, dtype=">f8")])
def test_a_value_copies_the_arrays_it_is_given(source):
    """An array is copied: writing to it afterwards changes nothing, and the result is read-only."""
    out = vector(source, 3, "x")
    before = out.tolist()
    source[:] = 7
    assert out.tolist() == before
    assert out.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        out[0] = 1.0


@pytest.mark.parametrize("kind", ["<f8", ">f8", "<i8"])
def test_an_array_on_bytes_keeps_its_values_and_is_read_only(kind):
    """An array that lies on bytes keeps its values, is shared only as float64, and is read-only."""
    source = np.frombuffer(np.arange(3).astype(kind).tobytes(), dtype=kind)
    out = vector(source, 3, "x")
    assert out.tolist() == [0.0, 1.0, 2.0]
    assert np.shares_memory(out, source) is (kind == "<f8")
    assert not out.flags.writeable


@pytest.mark.parametrize("values", [np.frombuffer(bytes(16)), [[1.0]], 1.0])
def test_a_wrong_shape_is_refused(values):
    """What is not a vector of the given size is a CommandError, on bytes too."""
    with pytest.raises(CommandError):
        vector(values, 1, "x")
