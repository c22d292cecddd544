"""A run as an xarray Dataset: every array under its name, with coordinates that say what its columns are."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from space_robot_bringup.public.arrays import XYZ, XYZW, RunArrays, is_of_joints
from space_robot_bringup.public.calls import needing

if TYPE_CHECKING:
    import xarray as xr


def dataset(arrays: RunArrays, unit: Callable[[str, str], str], attributes: dict[str, str]) -> xr.Dataset:
    """The Dataset of a run.

    Args:
        arrays: of the run.
        unit: see ``units_of``.
        attributes: of the whole.

    Raises:
        SpecError: xarray is not installed.
    """
    with needing("to_xarray", "xarray"):
        import xarray as xr
    variables: dict[str, Any] = {}
    for name, value, labels in arrays.variables():
        units = list(dict.fromkeys(unit(name, label) for label in labels or ("",)))
        said = {"units": " or ".join(units)} if any(units) else {}
        # A block of one number is a number over time.
        variables[name] = (("time", _columns(name, labels)), value, said) if labels else ("time", value[:, 0], said)
    coordinates = {
        "time": ("time", arrays.time, {"units": "s"}),
        "stamp": ("time", arrays.stamp, {"units": "ns"}),
        "axis": list(XYZ),
        "component": list(XYZW),
        "joint": list(arrays.joint_names),
    }
    return xr.Dataset(variables, coordinates, attributes)


def _columns(name: str, labels: tuple[str, ...]) -> str:
    """The dimension of an array beside time; each block of telemetry has its own."""
    if name.startswith("telemetry."):
        return f"{name}.number"
    if is_of_joints(name):
        return "joint"
    return "component" if labels == XYZW else "axis"
