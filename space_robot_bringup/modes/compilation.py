"""What is compiled before the first run on a machine, so that a wait is explained."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from space_robot_control.laws.base import Law
from space_robot_control.laws.policy import TYPED, LawPolicy
from space_robot_control.laws.registry import law_class
from space_robot_description.kernel.cache import cached
from space_robot_msgs_py.errors import SpecError
from space_robot_sim.kernel.cache import must_compile as plant_must_compile

PLANT_SECONDS, LAW_SECONDS, LANES_SECONDS = 20, 15, 15
LANES = Path(__file__).parents[1] / "fused" / "kernel" / "lanes.py"


def laws_to_compile(laws: Iterable[str], policy: LawPolicy = TYPED) -> list[str]:
    """The laws that have to be compiled before they can run, each once, in order."""
    return [name for name in dict.fromkeys(laws) if _must_compile(name, policy)]


def notice(laws: Iterable[str], *, plant: bool = True, many: bool = False, policy: LawPolicy = TYPED) -> str:
    """One line about what has to be compiled before such runs; empty if nothing has to.

    Args:
        laws: of the runs.
        plant: whether they need a plant.
        many: whether they run side by side, those that can.
        policy: whose code may be one of the laws.
    """
    laws, names, seconds = list(laws), [], 0
    if plant and plant_must_compile():
        names, seconds = ["the plant"], PLANT_SECONDS
    for name in laws_to_compile(laws, policy):
        names.append(f"the law {name}")
        seconds += LAW_SECONDS
    if many and not cached(LANES, "run_lanes") and any(_runs_compiled(name, policy) for name in laws):
        names.append("side-by-side runs")
        seconds += LANES_SECONDS
    return f"compiling {' and '.join(names)}, once (about {seconds} s)" if names else ""


def _must_compile(law: str, policy: LawPolicy) -> bool:
    try:
        return law_class(law, policy=policy).must_compile()
    except SpecError:
        return False  # the error is clearer where the law is made


def _runs_compiled(law: str, policy: LawPolicy) -> bool:
    try:
        return law_class(law, policy=policy).compiled is not Law.compiled
    except SpecError:
        return False
