"""How a robot looks: totals, bodies, joints."""

from __future__ import annotations

from collections.abc import Iterable

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from space_robot_cli.terminal import markup
from space_robot_description.reach import Reach
from space_robot_description.report import RobotReport


def show(console: Console, report: RobotReport) -> None:
    """Print a robot report: totals, bodies, joints."""
    totals = Table(
        title=f"{markup(report.name)}: {report.n} joints, {report.base_mode}", title_justify="left", box=None
    )
    totals.show_header = False
    for name, value in _totals(report).items():
        totals.add_row(name, value)
    console.print(totals)
    bodies = Table(box=SIMPLE_HEAD)
    bodies.add_column("body", no_wrap=True)
    for heading in ("mass [kg]", "com [m]", "Ixx, Iyy, Izz [kg m2]"):
        bodies.add_column(heading.replace("[", r"\["))
    for body in report.bodies:
        bodies.add_row(markup(body.name), f"{body.mass:g}", _numbers(body.com), _numbers(body.inertia.diagonal()))
    console.print(bodies)
    joints = Table(box=SIMPLE_HEAD)
    joints.add_column("joint", no_wrap=True)
    for heading in ("from", "to", "home", "effort\nlimit", "lag\n[s]", "friction\nviscous", "friction\nCoulomb"):
        joints.add_column(heading.replace("[", r"\["), justify="right")
    for row in report.joints:
        values = (row.lower, row.upper, row.home, row.effort, row.lag, row.viscous, row.coulomb)
        joints.add_row(markup(row.name), *(f"{value:.4g}" for value in values))
    console.print(joints)
    for name, of in report.followers.items():
        console.print(f"{name} follows {of['joint']}: {of['multiplier']:g} q + {of['offset']:g}", markup=False)
    for note in report.notes:
        console.print(note, markup=False, soft_wrap=True)


def _totals(report: RobotReport) -> dict[str, str]:
    wheels, force = report.momentum_capacity, report.force_capacity
    reaches = {report.tool_frame: report.reach} | {tool["link"]: tool["reach"] for tool in report.tools.values()}
    return {
        "mass": f"{report.total_mass:g} kg",
        "centre of mass at home": f"{_numbers(report.system_com)} m",
        "inertia at home (Ixx, Iyy, Izz)": f"{_numbers(report.system_inertia.diagonal())} kg m2",
        "momentum capacity per axis": f"{_numbers(wheels)} N m s" if wheels is not None else "no wheels",
        "torque capacity per axis": f"{_numbers(report.torque_capacity)} N m",
        "force capacity per axis": f"{_numbers(force)} N" if force is not None else "none (free-floating)",
        **{f"reach of {markup(link)}": _reach(reach) for link, reach in reaches.items()},
        "base-arm coupling, condition": f"{report.coupling.condition:.4g}",
        "base rate per joint rate": f"{report.coupling.rate_ratio:.4g}",
        "base torque per joint effort": f"{report.coupling.torque_ratio:.4g}",
    }


def _reach(reach: Reach) -> str:
    return f"{reach.sampled:.3f} m sampled, below {reach.sum_bound:.3f} m"


def _numbers(values: Iterable[float]) -> str:
    return ", ".join(f"{value:.4g}" for value in values)
