"""Gains of laws searched with the same budget for each, and judged on draws that the search never saw."""
