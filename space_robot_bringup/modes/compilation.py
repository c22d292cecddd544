"""What is compiled before the first run on a machine, so that a wait is explained."""

from __future__ import annotations

from collections.abc import Iterable

from space_robot_control.laws.policy import TYPED, LawPolicy
from space_robot_control.laws.registry import law_class
from space_robot_msgs_py.errors import SpecError
from space_robot_sim.kernel.cache import must_compile as plant_must_compile

PLANT_SECONDS, LAW_SECONDS = 20, 15


def laws_to_compile(laws: Iterable[str], policy: LawPolicy = TYPED) -> list[str]:
    """The laws that have to be compiled before they can run, each once, in order."""
    return [name for name in dict.fromkeys(laws) if _must_compile(name, policy)]


def notice(laws: Iterable[str], *, plant: bool = True, policy: LawPolicy = TYPED) -> str:
    """One line about what has to be compiled before such runs; empty if nothing has to.

    Args:
        laws: of the runs.
        plant: whether they need a plant.
        policy: whose code may be one of the laws.
    """
    names, seconds = [], 0
    if plant and plant_must_compile():
        names, seconds = ["the plant"], PLANT_SECONDS
    for name in laws_to_compile(laws, policy):
        names.append(f"the law {name}")
        seconds += LAW_SECONDS
    return f"compiling {' and '.join(names)}, once (about {seconds} s)" if names else ""


def _must_compile(law: str, policy: LawPolicy) -> bool:
    try:
        return law_class(law, policy=policy).must_compile()
    except SpecError:
        return False  # the error is clearer where the law is made
