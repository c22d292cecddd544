"""The regulator in plain scalar code."""
