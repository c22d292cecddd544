"""Computed torque in plain scalar code."""
