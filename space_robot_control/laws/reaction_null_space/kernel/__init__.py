"""The reaction null space in plain scalar code."""
