"""Numbers that several laws share, in plain scalar code: compiled where numba is, the same Python where it is not."""
