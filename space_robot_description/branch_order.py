"""The order of branches of a robot: by name, but a joint that follows another one comes behind it."""

from __future__ import annotations

from collections.abc import Mapping


def masters_first(
    children: Mapping[str, list[str]], child: Mapping[str, str], masters: Mapping[str, str]
) -> dict[str, list[str]]:
    """The joints on each link, in an order that visits masters before their followers where there is one.

    Pinocchio visits bodies depth first, and needs the coordinate of a follower to be there before it.

    Args:
        children: link -> its joints, sorted by name.
        child: joint -> the link it moves.
        masters: follower -> the joint it follows.
    """
    moved: dict[str, set[str]] = {}
    for joint in _outermost_first(children, child):
        moved[joint] = {joint}.union(*(moved[inner] for inner in children[child[joint]]))
    needed = {joint: {masters[one] for one in inside if one in masters} for joint, inside in moved.items()}
    return {link: _sorted(joints, moved, needed) for link, joints in children.items()}


def _outermost_first(children: Mapping[str, list[str]], child: Mapping[str, str]) -> list[str]:
    links = [link for link in children if link not in child.values()]
    found: list[str] = []
    for link in links:
        found += children[link]
        links += [child[joint] for joint in children[link]]
    return found[::-1]


def _sorted(joints: list[str], moved: Mapping[str, set[str]], needed: Mapping[str, set[str]]) -> list[str]:
    """By name, and behind the branches that it needs; where two need each other, by name alone."""
    left, out = list(joints), []
    while left:
        ready = [one for one in left if not any(needed[one] & moved[other] for other in left if other != one)]
        out.append(ready[0] if ready else left[0])
        left.remove(out[-1])
    return out
