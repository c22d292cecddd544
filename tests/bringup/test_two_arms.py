"""The shipped robot with two arms: the laws bring both tools to their places, and the plant keeps its balances."""

from __future__ import annotations

from typing import Any

import pytest

import space_robot as sr

# Of the campaign that compares them on the servicer.
GAINS: dict[str, dict[str, Any]] = {
    "computed_torque": {"bandwidth": 0.3, "damping": 1.0},
    "pd": {"bandwidth": 0.2, "damping": 1.0},
    "ntsmc": {"clamp": True, "saturation": "direction_preserving"},
    "adaptive": {"update": "lyapunov", "lambda": 0.5, "kappa": 0.2, "lead": True, "tracking": {"gain": 300}},
    "mfac": {"lead": 4.0, "kappa": 2.0},
}
REACH = {
    "kind": "end_effector",
    "points": [{"time": 20.0, "tools": {"left": {"move_by": [0.1, -0.1, 0.05]}, "right": {"move_by": [0.1, 0.1, 0]}}}],
}


@pytest.mark.parametrize("law", GAINS)
def test_every_law_moves_both_arms(law: str) -> None:
    """Unchanged, each law brings fourteen joints and the base where they belong; residuals are those of one arm."""
    run = sr.run(
        "point_to_point/dual_servicer",
        {
            "control_period": 0.25,
            "duration": 40.0,
            "reference": REACH,
            "controller": {"law": law, "gains": GAINS[law]},
            "expect": {},
        },
    )
    axes = {axis.name: axis for axis in run.metrics.axes}
    moved = [name for name in run.joint_names if axes[name].travel > 1.0]
    assert {name.partition("_")[0] for name in moved} == {"left", "right"}
    assert max(axes[name].max_error for name in run.joint_names) < 5.0
    assert max(axis.final_error for axis in axes.values()) < 1.0
    assert max(run.metrics.momentum_residual, run.metrics.energy_residual) < 1e-13
