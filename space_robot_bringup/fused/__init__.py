"""Runs in one compiled call, for studies of many runs: the same bits as the loop, without its values."""
