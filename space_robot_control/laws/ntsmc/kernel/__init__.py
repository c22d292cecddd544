"""The numbers of the sliding mode laws in plain scalar code."""
