"""Run a shipped task with another gain, look at its numbers and draw them.

python examples/run_and_plot.py
"""

import numpy as np

import space_robot as sr


def main() -> None:
    """Leave fig08.png in the working directory."""
    run = sr.run("liu2023/fig08", {"controller.gains.lambda": 0.7, "duration": 15.0})
    print(run.conclusion, "after", run.arrays.time[-1], "s")
    for name, angle in zip(run.joint_names, np.degrees(run.arrays.joints.position[-1]), strict=True):
        print(f"{name} ends at {angle:.2f} deg")
    for axis in run.metrics.axes:
        print(f"{axis.name}: off by {axis.final_error:.3g} {axis.unit}, settles at {axis.settling_time} s")
    run.plot().savefig("fig08.png")


if __name__ == "__main__":
    main()
