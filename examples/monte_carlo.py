"""A small Monte Carlo campaign: a task under parameters that are off, and how sure its result is.

python examples/monte_carlo.py
"""

import space_robot as sr


def main() -> None:
    """Eight runs; the table and the bags of those that failed are in mc/."""
    done = sr.campaign("fig08_dispersed", {"duration": 15.0, "plant.dispersion.eta": 0.1}, runs=8, out="mc")
    for group in done.groups:
        rate = group.success
        print(f"{rate.count} of {rate.n} runs succeed, 95 % interval {rate.low:.2f} to {rate.high:.2f}")
    worst = done.to_pandas().sort_values("base/pitch.max_error").iloc[-1]
    print(f"worst: case {worst.name}; again: space-robot run --from mc --index {worst.name}")


if __name__ == "__main__":
    main()
