"""Damped hold: every rate to zero by damping alone, a safe law."""
