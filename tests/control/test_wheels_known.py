"""Laws with a model count the momentum of the wheels."""

from __future__ import annotations

import pytest

import space_robot as sr


@pytest.mark.parametrize("law", ["computed_torque", "ntsmc"])
def test_a_law_that_counts_the_wheels_follows_several_times_closer(law: str) -> None:
    """A base that turns with wheels that hold momentum: omega x h in the command takes most of the error away."""

    def attitude_rms(gyroscopic: bool) -> float:
        controller = {"law": law, "gains": {"gyroscopic": gyroscopic}}
        run = sr.run("liu2023/all_axes", {"controller": controller, "nominal": {}})
        assert run.reason == "completed"
        return max(axis.rms_error for axis in run.metrics.axes[:3])

    assert attitude_rms(True) < attitude_rms(False) / 4.0
