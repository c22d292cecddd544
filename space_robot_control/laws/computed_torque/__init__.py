"""Computed torque: feed-forward and PD by inverse dynamics of the nominal model."""
