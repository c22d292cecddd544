"""One engine for many runs: worker processes, time limits, a journal of what is finished."""
