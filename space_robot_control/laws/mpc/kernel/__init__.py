"""Predictions over a horizon, and whether they fit the limits, in plain scalar code."""
