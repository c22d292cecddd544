"""Park: the arm to its stowed posture on a path within limits, a safe law."""
