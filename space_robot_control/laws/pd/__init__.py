"""PD on named channels, the baseline of the model-free law."""
