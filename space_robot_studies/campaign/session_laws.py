"""Laws of the running program itself, a notebook cell or a script: how worker processes get to know them."""

from __future__ import annotations

import json
import pickle
import re
import sys

from space_robot_bringup.public.calls import needing
from space_robot_control.laws.registry import law_class
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.campaign.spec import Campaign

MAIN = "__main__"
_NAMED = re.compile(rf"\b{MAIN}:[A-Za-z_]\w*")


def packed_laws(campaign: Campaign, scheduler: str | None) -> bytes:
    """The classes that a campaign names as ``__main__:Class``, by value; empty where it names none.

    What they use of the program, functions and constants, goes with them; modules are imported by the workers.

    Args:
        campaign: resolved.
        scheduler: of Dask, if its workers are to be used.

    Raises:
        SpecError: there is no such law, it cannot be sent, or it would have to go to another machine.
    """
    said = json.dumps(campaign.model_dump(mode="json", include={"experiment", "vary", "disperse"}))
    names = sorted(set(_NAMED.findall(said)))
    if not names:
        return b""
    if scheduler is not None:
        accepted = "a law in a file that all machines have, FILE.py:Class"
        raise SpecError("is known to this program only", key="controller.law", value=names[0], accepted=accepted)
    with needing("a law of this program in other processes", "campaign"):
        import cloudpickle
    try:
        packed: bytes = cloudpickle.dumps([law_class(name) for name in names])
    except (pickle.PicklingError, TypeError) as error:
        what = f"cannot be sent to other processes ({error})"
        raise SpecError(what, key="controller.law", value=", ".join(names), accepted="FILE.py:Class") from None
    return packed


def unpack_laws(packed: bytes) -> None:
    """In another process: make the laws of ``packed_laws`` known there under the same names."""
    # Made by this program and sent to its own workers through a pipe: no data of others.
    for law in pickle.loads(packed) if packed else ():
        setattr(sys.modules[MAIN], law.__name__, law)
