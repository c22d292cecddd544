"""Arm motion that does not turn its base."""
