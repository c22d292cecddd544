"""What a log contains, and the assessment of a log that may be truncated."""
