"""What decides: laws and references in pure NumPy and Pinocchio; ROS only in ``nodes``."""
