"""Damped hold in plain scalar code."""
