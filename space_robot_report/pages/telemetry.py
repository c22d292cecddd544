"""Blocks of telemetry on the page: plots of what changes, a line for what does not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from space_robot_bringup.judge.metrics import PER_RUN, Matrix, RunMetrics

# More numbers of a block that does not change are not listed.
MAX_LISTED = 12
OF_RUN = {"effort_integral": "N m s", "joint_limit": "rad or m", "integration_error": "rad or m"}


def is_constant(block: Matrix) -> bool:
    """Whether no number of a block changes over the log."""
    return bool((block == block[:1]).all())


def constants(blocks: Mapping[str, Matrix]) -> list[tuple[str, str]]:
    """Label and values of every block that does not change."""
    found = ((label, block[0]) for label, block in blocks.items() if block.size and is_constant(block))
    return [
        (label, f"{', '.join(f'{value:g}' for value in row[:MAX_LISTED])}{', ...' if row.size > MAX_LISTED else ''}")
        for label, row in found
    ]


def check_units(metrics: RunMetrics | None) -> dict[str, str]:
    """Name to unit of every metric that has one."""
    units = dict.fromkeys(PER_RUN, "") | OF_RUN
    for axis in metrics.axes if metrics is not None else ():
        errors = dict.fromkeys(("final_error", "max_error", "rms_error"), axis.unit)
        parts = errors | {"settling_time": "s", "overshoot": "%"}
        units |= {f"{axis.name}.{part}": unit for part, unit in parts.items()}
    return {name: unit for name, unit in units.items() if unit}


def varying(blocks: Mapping[str, Matrix], shown: Sequence[str] = ()) -> dict[str, Matrix]:
    """The blocks that change and are not shown elsewhere."""
    return {
        label: block
        for label, block in blocks.items()
        if label not in shown and block.shape[1] and not is_constant(np.asarray(block))
    }
