"""Many runs of one experiment: what is dispersed and varied, how they are run, what they add up to."""
