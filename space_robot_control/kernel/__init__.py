"""The numbers of the adaptive law in plain scalar code: compiled where numba is, the same Python where it is not."""
