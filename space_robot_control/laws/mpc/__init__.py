"""Linear model predictive control with the limits of the actuators."""
