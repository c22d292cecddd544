"""Every combination of two gains, on all cores, as one table.

python examples/sweep_gains.py
"""

import space_robot as sr

GAINS = {"controller.gains.lambda": [0.5, 1.0, 2.0], "controller.gains.kappa": [1.0, 2.0]}


def main() -> None:
    """Print which gains settle soonest, and what they cost."""
    done = sr.sweep("liu2023/fig08", GAINS, {"duration": 15.0})
    table = done.to_pandas()
    columns = [*GAINS, "base/pitch.settling_time", "joint2.overshoot", "effort_integral"]
    print(table[columns].sort_values("base/pitch.settling_time").to_string(index=False))


if __name__ == "__main__":
    main()
