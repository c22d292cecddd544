"""The model-free law in plain scalar code."""
