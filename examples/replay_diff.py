"""A log as a regression test: compute it again, then with another gain, and see where it differs.

python examples/replay_diff.py
"""

import space_robot as sr


def main() -> None:
    """Record, replay, and replay with a change."""
    run = sr.run("liu2023/fig08", {"duration": 5.0}, out="recorded", overwrite=True)
    print("as recorded:", "equal" if sr.replay(run).equal else "different")
    changed = sr.replay("recorded", {"controller.gains.kappa": 1.5}, against="controller")
    for outcome in changed.outcomes:
        print("with another gain:", "equal" if outcome.equal else "different")
        print("first:", outcome.first)


if __name__ == "__main__":
    main()
