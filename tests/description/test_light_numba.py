"""What numba loads for kernels, and what custom code may still compile."""

from __future__ import annotations

import subprocess
import sys

import pytest

from space_robot_description.kernel import jit

PROGRAM = """
import sys
import numpy as np
from space_robot_description.kernel.jit import kernel
import numba

def doubled(values):
    return 2.0 * values.sum()

assert kernel(doubled)(np.ones(3)) == 6.0
assert "scipy.linalg" not in sys.modules
assert (numba.njit(lambda a: a @ a)(2.0 * np.eye(2)) == 4.0 * np.eye(2)).all()
assert "scipy.linalg" in sys.modules
"""


@pytest.mark.skipif(not jit.COMPILED, reason="numba is not installed")
def test_kernels_load_no_scipy_and_custom_code_may() -> None:
    """A kernel is compiled without SciPy's BLAS; a product of matrices in custom compiled code loads it."""
    pytest.importorskip("scipy")
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
