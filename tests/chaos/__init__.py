"""Programs that break a run on purpose and count what is left: ``make chaos``."""
