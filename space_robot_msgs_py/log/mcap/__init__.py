"""MCAP records below the log: chunks, index, salvage."""
