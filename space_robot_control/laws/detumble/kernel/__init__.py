"""Detumble in plain scalar code."""
