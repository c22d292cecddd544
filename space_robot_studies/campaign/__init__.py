"""Many runs of one experiment: what strays, who flies them, what they add up to."""
