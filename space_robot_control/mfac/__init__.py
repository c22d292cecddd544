"""Model-free adaptive control without a robot: pseudo-partial derivative, incremental law, filter, stability."""
