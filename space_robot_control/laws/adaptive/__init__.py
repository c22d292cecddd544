"""The adaptive law of Liu, Teng, Jin 2023: linear separation of the inertial parameters, and its updates."""
