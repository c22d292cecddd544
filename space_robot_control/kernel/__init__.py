"""Kernels that several laws share: plain scalar code, compiled where numba is, the same Python where it is not."""
