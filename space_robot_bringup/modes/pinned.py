"""The environment of processes that run: one thread per numeric library; it imports nothing, to be read before them."""

from __future__ import annotations

# Matrices here are small: more threads only compete for the cores that other runs need.
PINNED = {
    name: "1"
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "BLIS_NUM_THREADS")
}
