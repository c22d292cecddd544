"""What cannot be flexible like that is one error with the key as typed, the value and what is accepted."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.compose.foresight import foreseen
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_sim.spec import IntegratorSpec, fixed_steps
from tests.sim.flexible.runs import GEARS, PANEL, PERIOD, TANK, block, moving, plant_of, simulate

PANEL_ON_MINI: dict[str, Any] = PANEL | {"mass": 1.0, "inertia": [0.02, 0.005, 0.02], "com": [0.0, 0.3, 0.0]}
PANEL_ON_MINI |= {"hinge": [0.0, 0.2, 0.0]}


def composed(flexibility: Any, **overrides: Any) -> Any:
    """The experiment of Fig. 8 with it."""
    return compose(load_experiment("liu2023/fig08", {"plant.flexibility": flexibility, **overrides}))


@pytest.mark.parametrize(
    ("flexibility", "key", "words"),
    [
        ({"appendages": [PANEL_ON_MINI | {"link": "bas_link"}]}, "plant.flexibility.appendages.0.link", "base_link"),
        ({"appendages": [PANEL_ON_MINI | {"mass": 60.0}]}, "plant.flexibility.appendages.0.mass", "added: true"),
        ({"appendages": [PANEL_ON_MINI | {"mass": 25.0}]}, "plant.flexibility.appendages.0", "added: true"),
        ({"appendages": [PANEL_ON_MINI | {"axis": [0, 0, 0]}]}, "plant.flexibility.appendages.0", "axis"),
        (
            {"appendages": [PANEL_ON_MINI | {"axis": [0, 1, 0], "inertia": [0, 0, 0]}]},
            "plant.flexibility.appendages.0.com",
            "off the axis",
        ),
        ({"appendages": [PANEL_ON_MINI, PANEL_ON_MINI]}, "plant.flexibility", "panel is there twice"),
        ({"appendages": [PANEL_ON_MINI | {"damping": 1.0}]}, "plant.flexibility.appendages.0.damping", "1"),
        ({"appendages": [PANEL_ON_MINI | {"name": "a b"}]}, "plant.flexibility.appendages.0.name", "a b"),
        ({"slosh": [TANK | {"axes": ["x", "x"]}]}, "plant.flexibility.slosh.0", "once"),
        ({"slosh": [TANK | {"mass": 1.0, "axes": ["x"]}]}, "plant.flexibility.slosh.0", "does not move along y"),
        ({}, "plant.flexibility", "missing"),
        ({"joints": GEARS | {"stiffness": {"joint9": 1.0}}}, "plant.flexibility.joints.stiffness", "joint4"),
        ({"joints": GEARS | {"stiffness": 0.0}}, "plant.flexibility.joints.stiffness", "> 0"),
        ({"joints": GEARS | {"rotor_inertia": -1.0}}, "plant.flexibility.joints.rotor_inertia", "> 0"),
        ({"joints": GEARS | {"damping": -1.0}}, "plant.flexibility.joints.damping", ">= 0"),
        ({"joints": GEARS | {"stiffness": 1e14}}, "plant.flexibility", "softer springs"),
    ],
)
def test_what_does_not_fit_names_the_key(flexibility: Any, key: str, words: str) -> None:
    """Links, masses, axes, names, gears."""
    with pytest.raises(SpaceRobotError) as caught:
        composed(flexibility)
    text = str(caught.value)
    assert key in text
    assert words in text
    assert "\n" not in text


def test_brakes_that_close_by_themselves_are_refused_with_gears_and_not_with_panels() -> None:
    """`plant.hold.brakes` and `joint_stuck` need a rigid gear."""
    hold = {"plant.hold": {"last_for": 2, "brakes": True}}
    composed({"appendages": [PANEL_ON_MINI]}, **hold)
    with pytest.raises(SpecError, match="no brake"):
        composed({"joints": GEARS}, **hold)
    with pytest.raises(SpecError, match=r"faults\.0\.joint"):
        composed({"joints": GEARS}, faults=[{"kind": "joint_stuck", "joint": "joint2", "at": 2.0}])


def test_a_link_that_gets_lighter_in_the_run_has_to_keep_the_panel() -> None:
    """A fault that leaves less of the base than what swings on it is refused before the run."""
    fault = {"kind": "inertia_change", "body": "base_link", "factor": 0.01, "at": 2.0}
    with pytest.raises(SpecError, match=r"plant\.flexibility\.appendages\.0\.mass"):
        composed({"appendages": [PANEL_ON_MINI]}, faults=[fault])


def test_a_link_off_the_last_branch_is_refused() -> None:
    """Pinocchio's matrices need depth-first order; base and last branch are named."""
    panel = PANEL_ON_MINI | {"link": "left_link3"}
    with pytest.raises(SpaceRobotError) as caught:
        compose(load_experiment("point_to_point/dual_servicer", {"plant.flexibility": {"appendages": [panel]}}))
    assert "plant.flexibility.appendages.0.link" in str(caught.value)
    assert "base_link" in str(caught.value)


def test_steps_resolve_the_fastest_mode() -> None:
    """Left out, a step is chosen that does and divides the period; one that is typed and does not is refused."""
    rate = 2.0 * np.pi * 40.0
    assert fixed_steps(IntegratorSpec(), "dop853", PERIOD) == 2
    steps = fixed_steps(IntegratorSpec(), "dop853", PERIOD, rate)
    assert PERIOD % steps == 0
    assert rate * 0.1 / steps <= 0.5
    with pytest.raises(SpecError) as caught:
        fixed_steps(IntegratorSpec(step=0.05), "dop853", PERIOD, rate)
    assert caught.value.key == "plant.integrator.step"
    assert "40 Hz" in str(caught.value)
    with pytest.raises(SpecError, match=r"plant\.integrator\.step"):
        plant_of({"joints": GEARS | {"stiffness": 1e5}}, integrator={"step": 0.05})


def test_chosen_steps_are_fine_enough() -> None:
    """Stiff gears at the chosen step end where error-controlled steps of 1e-12 do."""
    gears = {"joints": GEARS | {"stiffness": 3e4, "damping": 3.0}}
    ends = []
    for how in ({"kind": "dop853"}, {"kind": "dop853_adaptive", "rtol": 1e-12, "atol": 1e-14}):
        samples = simulate(plant_of(gears, state=moving(), integrator=how), 20, 2.0)
        ends.append(block(samples, "true_configuration")[-1])
    np.testing.assert_allclose(*ends, atol=1e-9)


def test_check_warns_of_modes_that_are_fast_for_the_control_period() -> None:
    """One sentence with the frequency and how often it is seen; slow modes are no news."""
    said = [text for text in foreseen(composed({"joints": GEARS})) if "flexibility" in text]
    assert len(said) == 1
    assert "Hz" in said[0]
    slow = foreseen(composed({"appendages": [PANEL_ON_MINI | {"frequency": 0.05}]}))
    assert not [text for text in slow if "flexibility" in text]


def test_nothing_said_is_nothing_in_the_file() -> None:
    """The plant section of a rigid run has no key of that name."""
    assert "flexibility" not in load_experiment("liu2023/fig08").plant.model_dump(mode="json")
