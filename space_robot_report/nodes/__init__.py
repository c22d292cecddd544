"""Nodes that show a run; ROS is imported here and nowhere else in this package."""
