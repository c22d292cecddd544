"""The comparison as numbers: rows of a campaign by law, period and condition; failures are counted, not left out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import hypot
from typing import Any

import numpy as np

from space_robot_description.load import load_robot
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.campaign.cases import Case, make_case
from space_robot_studies.campaign.spec import Campaign

LAW_KEYS = ("controller", "controller.law")
PERIOD = "control_period"
ROTATION = ("base/roll", "base/pitch", "base/yaw")
# Name to what it is, in the order of the tables.
METRICS = {
    "settling_time": "settling time of the slowest axis [s]",
    "joint_error": "largest joint error of the run [deg]",
    "attitude_rms": "rms attitude error [deg]",
    "attitude_final": "final attitude error, worst axis [deg]",
    "torque_integral": "torque integral [N m s]",
    "saturation_share": "share of periods at a limit [-]",
}


@dataclass(frozen=True, slots=True)
class Cell:
    """What the runs of one law did at one period in one condition.

    Attributes:
        law: label of the law.
        period: control period [s].
        condition: key to label of all else that is varied.
        runs: number of runs.
        ended: runs that ended before their time.
        settled: completed runs of which every axis with a settling band settled.
        reasons: how the ended ones ended, and how often.
        medians: metric to its median over the completed runs that have it; None where none has.
    """

    law: str
    period: float
    condition: Mapping[str, Any]
    runs: int
    ended: int
    settled: int
    reasons: Mapping[str, int]
    medians: Mapping[str, float | None]


@dataclass(frozen=True, slots=True)
class Comparison:
    """All cells of a campaign.

    Attributes:
        name: of the campaign.
        title: likewise.
        cells: in the order of the grid.
    """

    name: str
    title: str
    cells: tuple[Cell, ...]

    @property
    def laws(self) -> list[str]:
        """Labels of the laws, in the order of the file."""
        return list(dict.fromkeys(cell.law for cell in self.cells))

    @property
    def periods(self) -> list[float]:
        """Control periods [s], shortest first."""
        return sorted({cell.period for cell in self.cells})

    @property
    def conditions(self) -> list[dict[str, Any]]:
        """What else is varied, in the order of the file; one empty one where nothing is."""
        found: list[dict[str, Any]] = []
        for cell in self.cells:
            if dict(cell.condition) not in found:
                found.append(dict(cell.condition))
        return found

    def cell(self, law: str, period: float, condition: Mapping[str, Any]) -> Cell:
        """The cell at a place of the table."""
        (found,) = (c for c in self.cells if (c.law, c.period, c.condition) == (law, period, condition))
        return found

    def to_dict(self) -> dict[str, Any]:
        """Plain data; nothing in it depends on the machine."""
        return {"name": self.name, "title": self.title, "metrics": METRICS, "cells": [asdict(c) for c in self.cells]}


def law_key(campaign: Campaign, name: str) -> str:
    """The key by which a campaign varies its law.

    Raises:
        SpecError: it varies no law, or its experiment does not define what settled means.
    """
    keys = [key for key in LAW_KEYS if key in campaign.vary]
    if len(keys) != 1:
        raise SpecError("compares no laws", key=f"{name} vary", accepted=f"one of: {', '.join(LAW_KEYS)}")
    if not make_case(campaign, 0).experiment().settling_bands:
        accepted = "a band for every axis that has to settle, the same for all laws"
        raise SpecError("are missing", key=f"{name} settling_bands", accepted=accepted)
    return keys[0]


def side_by_side(campaign: Campaign, name: str, rows: Sequence[Mapping[str, Any]]) -> Comparison:
    """The rows of a finished campaign by law, period and condition.

    Args:
        campaign: resolved.
        name: of it.
        rows: columns by name, all cases in order.

    Raises:
        SpecError: see ``law_key``.
    """
    key = law_key(campaign, name)
    cells = []
    for at in range(campaign.points):
        labels = dict(campaign.point(at).labels)
        law = str(labels.pop(key))
        labels.pop(PERIOD, None)
        cells.append(_cell(make_case(campaign, at), law, labels, rows[at :: campaign.points]))
    return Comparison(name, campaign.title, tuple(cells))


def _cell(first: Case, law: str, condition: Mapping[str, Any], rows: Sequence[Mapping[str, Any]]) -> Cell:
    experiment = first.experiment()
    robot = load_robot(experiment.robot)
    angles = [name for name, length in zip(robot.joint_names, robot.prismatic, strict=True) if not length]
    completed = [task_numbers(row, angles, list(experiment.settling_bands)) for row in rows if row["completed"]]
    reasons = [row["end_reason"] for row in rows if not row["completed"]]
    return Cell(
        law=law,
        period=experiment.control_period,
        condition=condition,
        runs=len(rows),
        ended=len(reasons),
        settled=sum(numbers["settling_time"] is not None for numbers in completed),
        reasons={reason: reasons.count(reason) for reason in dict.fromkeys(reasons)},
        medians={metric: _median([numbers[metric] for numbers in completed]) for metric in METRICS},
    )


def task_numbers(row: Mapping[str, Any], angles: Sequence[str], banded: Sequence[str]) -> dict[str, float | None]:
    """``METRICS`` of one completed run.

    Args:
        row: columns by name.
        angles: names of the revolute joints.
        banded: axes that have to settle.

    Returns:
        None where there is no such number: an axis that did not settle, or none that has to; no revolute joint.
    """
    settled = [row[f"{axis}.settling_time"] for axis in banded]
    return {
        "settling_time": None if None in settled else max(settled, default=None),
        "joint_error": max((row[f"{joint}.max_error"] for joint in angles), default=None),
        "attitude_rms": hypot(*(row[f"{axis}.rms_error"] for axis in ROTATION)),
        "attitude_final": max(row[f"{axis}.final_error"] for axis in ROTATION),
        "torque_integral": row["effort_integral"],
        "saturation_share": row["saturation_share"],
    }


def _median(values: Sequence[float | None]) -> float | None:
    there = [value for value in values if value is not None]
    return float(np.median(there)) if there else None
