"""The PD law in plain scalar code."""
