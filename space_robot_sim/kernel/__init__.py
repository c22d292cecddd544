"""The numbers of the plant in plain scalar code: compiled by numba where it is installed, the same Python where not."""
