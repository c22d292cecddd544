"""Linear quadratic regulator on the sampled linear model of the posture."""
