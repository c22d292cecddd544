"""Robots that hold a second body in a grasp that gives way: the air-bearing testbed and captured debris."""
