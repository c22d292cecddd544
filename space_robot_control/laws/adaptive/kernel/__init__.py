"""The numbers of the adaptive law in plain scalar code."""
