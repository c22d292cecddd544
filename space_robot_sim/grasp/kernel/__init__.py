"""The motion of a robot with a grasp in plain scalar code."""
