"""Which runs are likely to go side by side in one compiled call; the worker that tries decides."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from importlib.util import find_spec
from typing import Any

from space_robot_bringup.experiment.experiment import Experiment

# Laws that a run can call without Python between its ticks, with most gains: see ``Law.compiled``.
FOLLOWING = ("adaptive", "computed_torque", "lqr", "mfac", "mpc", "ntsmc", "ntsmc_euler", "pd", "reaction_null_space")
COMPILED = frozenset((*FOLLOWING, "damped_hold", "detumble", "park"))
# A run keeps 2 kB a tick, and eight of them are there at once.
MAX_TICKS = 20_000


def kind_of_case(data: Mapping[str, Any]) -> Hashable | None:
    """The same of experiments that may share a call; None: this one is run alone.

    Args:
        data: the experiment, with all defaults, not yet checked.
    """
    controller, plant = data["controller"], data["plant"]
    law = controller.get("law")
    loop = any(controller.get(key) for key in ("standby", "switches")) or data.get("faults") or data.get("supervision")
    if loop or law not in COMPILED or plant.get("kind") != "articulated" or find_spec("numba") is None:
        return None
    period, duration = data["control_period"], data["duration"]
    return (law, period, duration) if duration <= MAX_TICKS * period else None


def kind_of_experiment(experiment: Experiment) -> Hashable | None:
    """``kind_of_case`` of a checked experiment."""
    controller = {key: getattr(experiment.controller, key) for key in ("law", "standby", "switches")}
    names = ("control_period", "duration", "faults", "supervision")
    plant = {"kind": experiment.plant.kind}
    return kind_of_case({"controller": controller, "plant": plant} | {key: getattr(experiment, key) for key in names})
