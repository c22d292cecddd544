"""The loop of plant and law as one compiled function."""
