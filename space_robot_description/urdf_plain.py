"""A URDF in one spelling: without other programs' elements, numbers and origins as the strictest reader wants them."""

from __future__ import annotations

import difflib
import re
from xml.etree import ElementTree as ET

import pinocchio as pin

from space_robot_description.rotations import normalized
from space_robot_description.urdf_values import ATTRIBUTES, numbers, single
from space_robot_msgs_py.errors import SpecError

# Simulator and driver extensions say nothing about the body; they also quote joint names that may be changed here.
IGNORED = ("gazebo", "transmission", "ros2_control")
_IN_INERTIAL = ("origin", "mass", "inertia")
# A misspelt one of these would lose what it says; whatever else stands there is another program's.
_MEANT = {
    "robot": ("link", "joint"),
    "link": ("inertial",),
    "inertial": _IN_INERTIAL,
    "joint": ("origin", "parent", "child", "axis", "limit", "mimic"),
}
_OFF_DIAGONAL = ("ixy", "ixz", "iyz")
_LOOKS = ("size", "scale", "radius", "length", "rgba")
_NUMERIC = {name for names in (*ATTRIBUTES.values(), _LOOKS) for name in names} - {"link", "joint"}
_XACRO = (
    "`urdf: FILE.xacro` in the robot file, or plain URDF, which `xacro FILE.xacro -o FILE.urdf` makes of the source"
)


def plain_robot(root: ET.Element, where: str) -> None:
    """Bring a ``<robot>`` into the one spelling that composition, the model and other programs read alike.

    Removed: elements and attributes of other name spaces, and ``IGNORED``. A default name space on ``<robot>`` is no
    other one. ``quat_xyzw`` becomes ``rpy``, what is left out and means 0 is written, numbers lose the blanks around
    them.

    Raises:
        SpecError: not a URDF, a version that does not exist, xacro, an element twice, or a name that is none of URDF's.
    """
    _strip_default_namespace(root)
    if root.tag != "robot":
        raise SpecError("not a URDF", key=where, value=f"<{root.tag}>", accepted="<robot> at the top")
    quaternions = _has_quaternions(root, where)
    for owner in (root, *root.findall("link"), *root.findall("joint")):
        for element in [child for child in owner if child.tag in IGNORED]:
            owner.remove(element)
    _refuse_macros(root, where)
    _drop_foreign(root, where)
    _refuse_expressions(root, where)
    _check_names(root, where)
    for tag in ("link", "joint"):
        for element in root.findall(tag):
            key = f"{tag} {element.get('name', '')}"
            _check_names(element, key)
            for origin in element.iter("origin"):
                _plain_origin(origin, key, quaternions)
    for link in root.findall("link"):
        _plain_inertial(link, f"link {link.get('name', '')}")
    for joint in root.findall("joint"):
        _plain_joint(joint, f"joint {joint.get('name', '')}")
    _strip_numbers(root)


def _strip_default_namespace(root: ET.Element) -> None:
    if root.tag.endswith("}robot"):
        space = root.tag.removesuffix("robot")
        for element in root.iter():
            element.tag = element.tag.removeprefix(space)


def _has_quaternions(root: ET.Element, where: str) -> bool:
    """Whether this version of URDF has ``quat_xyzw``."""
    version = root.get("version", "1.0").strip()
    parts = re.fullmatch(r"([0-9]{1,3})(?:\.([0-9]{1,3}))?(?:\.[0-9]{1,3})?", version)
    found = (int(parts[1]), int(parts[2] or 0)) if parts else (0, 0)
    if not (1, 0) <= found <= (1, 2):
        raise SpecError("unknown version of URDF", key=where, value=version, accepted="1.0, 1.1 or 1.2")
    # One form of it, which urdfdom reads too.
    if "version" in root.attrib:
        root.set("version", f"{found[0]}.{found[1]}")
    return found >= (1, 1)


def _refuse_macros(root: ET.Element, where: str) -> None:
    for element in root.iter():
        space, _, name = element.tag.rpartition("}")
        if "xacro" in space:
            raise SpecError("xacro in the URDF", key=where, value=f"<xacro:{name}>", accepted=_XACRO)


def _refuse_expressions(root: ET.Element, where: str) -> None:
    for part in [child for child in root if child.tag in ("link", "joint", "material")]:
        for element in part.iter():
            for text in (*element.attrib.values(), element.text or ""):
                if "${" in text:
                    raise SpecError("xacro in the URDF", key=where, value=text.strip()[:80], accepted=_XACRO)


def _drop_foreign(root: ET.Element, where: str) -> None:
    for element in list(root.iter()):
        for child in [child for child in element if child.tag.startswith("{")]:
            space, _, name = child.tag[1:].partition("}")
            if name in _MEANT.get(element.tag, ()):
                what = f"<{name}> in <{element.tag}> has another name space"
                raise SpecError(what, key=where, value=space, accepted=f"<{name}> without one")
            element.remove(child)
        for name in [name for name in element.attrib if name.startswith("{")]:
            del element.attrib[name]


def _check_names(element: ET.Element, key: str) -> None:
    meant = _MEANT[element.tag]
    for child in element:
        close = difflib.get_close_matches(child.tag, meant, n=1, cutoff=0.8) if child.tag not in meant else []
        if close:
            raise SpecError("unknown element", key=key, value=f"<{child.tag}>", accepted=f"did you mean <{close[0]}>?")


def _plain_origin(origin: ET.Element, key: str, quaternions: bool) -> None:
    if "quat_xyzw" not in origin.attrib:
        return
    text = origin.attrib.pop("quat_xyzw")
    if not quaternions:
        accepted = 'rpy, or <robot version="1.1"> at the top'
        raise SpecError("quat_xyzw is none of URDF 1.0", key=key, value=text, accepted=accepted)
    if "rpy" in origin.attrib:
        raise SpecError("<origin> has two rotations", key=key, value=text, accepted="rpy or quat_xyzw")
    x, y, z, w = normalized(numbers(ET.Element("origin", quat_xyzw=text), "quat_xyzw", "0 0 0 1", key), key)
    rpy = pin.rpy.matrixToRpy(pin.Quaternion(w, x, y, z).toRotationMatrix()).tolist()
    origin.set("rpy", " ".join(map(repr, rpy)))


def _plain_inertial(link: ET.Element, key: str) -> None:
    inertial = single(link, "inertial", key)
    if inertial is None:
        return
    for child in inertial:
        if child.tag not in _IN_INERTIAL:
            accepted = ", ".join(f"<{tag}>" for tag in _IN_INERTIAL)
            raise SpecError("unknown element in <inertial>", key=key, value=f"<{child.tag}>", accepted=accepted)
    for tag in _IN_INERTIAL:
        single(inertial, tag, key)
    mass, inertia = inertial.find("mass"), inertial.find("inertia")
    if mass is None and (inertia is None or not inertia.attrib):
        link.remove(inertial)
        return
    if inertia is None:
        inertia = ET.SubElement(inertial, "inertia")
    for entry in ATTRIBUTES["inertia"] if not inertia.attrib else _OFF_DIAGONAL:
        inertia.attrib.setdefault(entry, "0")


def _plain_joint(joint: ET.Element, key: str) -> None:
    for tag in _MEANT["joint"]:
        single(joint, tag, key)
    # A limit of 0 is one that is not given.
    limit = joint.find("limit")
    if limit is not None:
        for name in ("effort", "velocity"):
            limit.attrib.setdefault(name, "0")


def _strip_numbers(root: ET.Element) -> None:
    for element in root.iter():
        for name, text in element.attrib.items():
            if name in _NUMERIC:
                element.set(name, text.strip())
