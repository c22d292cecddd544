"""A short run: experiment and changes, as texts too."""

from __future__ import annotations

NAME, CHANGES = "liu2023/fig08", {"duration": 2.0, "controller.gains.lambda": 0.7}
TEXTS = ["duration=2.0", "controller.gains.lambda=0.7"]
