"""Let an optimiser choose a gain: the bandwidth with the least error, effort counted.

python examples/tune_gain.py
"""

from scipy.optimize import minimize_scalar

import space_robot as sr

TASK = sr.load_experiment("liu2023/fig08", {"controller.law": "computed_torque", "duration": 12.0, "expect": {}})


def cost(bandwidth: float) -> float:
    """Sum of rms errors [deg] and a share of the effort integral [N m s]; a run that ends early costs much."""
    run = sr.run(TASK, {"controller.gains.bandwidth": float(bandwidth)})
    if run.reason != "completed":
        return 1e3
    return sum(axis.rms_error for axis in run.metrics.axes) + 0.05 * run.metrics.effort_integral


def main() -> None:
    """Ten runs; each is the same whenever it is asked for, so the optimiser sees a function without noise."""
    found = minimize_scalar(cost, bounds=(0.2, 2.0), method="bounded", options={"maxiter": 10})
    print(f"bandwidth {found.x:.3f} rad/s, cost {found.fun:.3f} after {found.nfev} runs")


if __name__ == "__main__":
    main()
