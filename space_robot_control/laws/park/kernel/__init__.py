"""Park in plain scalar code."""
