"""Joints that follow another one, from `<mimic>`: which coordinate moves them, and how."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from xml.etree import ElementTree as ET

import pinocchio as pin

from space_robot_description.urdf import MOVING, Tree, kind_of
from space_robot_description.urdf_values import number
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.mimic import Mimic


def mimic_of(name: str, joint: ET.Element) -> Mimic | None:
    """What a joint follows as its ``<mimic>`` says; None if it has none.

    Raises:
        SpecError: no joint is named, or a number is none.
    """
    element, key = joint.find("mimic"), f"joint {name}"
    if element is None or kind_of(joint) not in MOVING:
        return None
    master = element.get("joint", "")
    if not master:
        raise SpecError("mimics a joint without a name", key=key, accepted='<mimic joint="..."/>')
    multiplier, offset = number(element, "multiplier", key), number(element, "offset", key)
    return Mimic(master, 1.0 if multiplier is None else multiplier, offset or 0.0)


def read_mimics(tree: Tree) -> dict[str, Mimic]:
    """Every follower, and the coordinate that moves it: a follower of a follower follows the first of the chain.

    Raises:
        SpecError: it follows a joint that is not there or fixed, or itself.
    """
    said = {name: mimic for name, joint in tree.joints.items() if (mimic := mimic_of(name, joint)) is not None}
    return {name: _resolved(name, said, tree) for name in said}


def couple(model: Any, mimics: Mapping[str, Mimic]) -> Any:
    """The ``pin.Model`` in which followers have no coordinate of their own.

    Args:
        model: every joint has its coordinate.
        mimics: see ``read_mimics``.

    Raises:
        SpecError: a follower carries its master, so that no order of the bodies has the master first.
    """
    for name, mimic in mimics.items():
        master, follower = model.getJointId(mimic.joint), model.getJointId(name)
        if follower < master:
            raise SpecError(
                f"mimics {mimic.joint}, which it carries or whose branch follows this one",
                key=f"joint {name}",
                accepted=f"let {mimic.joint} mimic {name}, or lock one of them in locked_joints",
            )
        model = pin.transformJointIntoMimic(model, master, follower, mimic.multiplier, mimic.offset)
    return model


def has_followers(model: Any) -> bool:
    """Whether joints of a free-flying ``pin.Model`` share a coordinate."""
    return bool(model.nv < model.njoints + 4)


def _resolved(name: str, said: Mapping[str, Mimic], tree: Tree) -> Mimic:
    """Follow the chain."""
    found, passed = said[name], [name]
    while found.joint in said:
        passed.append(found.joint)
        if found.joint in passed[:-1]:
            raise SpecError("mimics itself", key=f"joint {name}", value=" -> ".join(passed), accepted="another joint")
        found = found.through(said[found.joint])
    master = tree.joints.get(found.joint)
    if master is None or kind_of(master) not in MOVING:
        what = "is not there" if master is None else "does not move"
        movable = [one for one, joint in tree.joints.items() if kind_of(joint) in MOVING and one not in said]
        accepted = f"{nearest(found.joint, movable) or ', '.join(movable)}; or lock it in locked_joints"
        raise SpecError(f"mimics a joint that {what}", key=f"joint {passed[-1]}", value=found.joint, accepted=accepted)
    return found
