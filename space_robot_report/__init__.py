"""Logs turned into something to look at."""
