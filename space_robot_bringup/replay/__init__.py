"""Recorded runs computed again: states in, commands out; commands in, states out; and what is different."""
