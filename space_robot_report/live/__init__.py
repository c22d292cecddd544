"""A run while it goes on: shown by a process beside it, to browsers and to Foxglove."""
