"""Numba without what no kernel uses: a third of a second less in every process that runs something."""

from __future__ import annotations

from contextlib import suppress


def without_scipy() -> None:
    """Load numba's arrays without SciPy, whose BLAS they look for though only products of matrices need it.

    A custom law whose compiled code multiplies matrices loads SciPy then, or fails as numba fails where there is none.
    """
    # Private names: where they are others, SciPy is loaded as before.
    with suppress(ImportError, AttributeError):
        from numba.np import linalg

        looks = linalg.ensure_blas
        linalg.ensure_blas = lambda: None
        try:
            import numba.np.arraymath  # noqa: F401
        finally:
            linalg.ensure_blas = looks
