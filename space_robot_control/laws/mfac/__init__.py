"""Model-free adaptive control of Song, Zheng, Guo, Yuan 2023."""
