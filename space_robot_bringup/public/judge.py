"""`space_robot.judge`: what a recorded run shows of what is expected of it, without running anything."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from space_robot_bringup.compose.composition import check_expect
from space_robot_bringup.experiment.expectations import AnyExpectation
from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.judging import judge_blocks
from space_robot_bringup.logs.logged import compose_logged, logged_experiment
from space_robot_bringup.public.calls import for_python
from space_robot_description.frozen import plain
from space_robot_description.spec import Strict
from space_robot_description.validation import validate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.paths import StrPath


class _Expected(Strict):
    expect: dict[str, AnyExpectation]


@for_python
def judge(log: StrPath, expect: Mapping[str, Any] | None = None) -> tuple[Check, ...]:
    """Judge a recorded run by what is expected of it; nothing of the log is changed, and no law is made.

    Args:
        log: a run, run directory or .mcap file.
        expect: as the section ``expect`` of an experiment; None: what the recorded experiment expects.

    Returns:
        Check by check: the end, the plant's own bounds, then what is expected, in order.

    Raises:
        SpaceRobotError: the log cannot be read, or names in ``expect`` mean nothing in it.
    """
    reader = LogReader(log)
    composition = compose_logged(logged_experiment(reader.header.experiment))
    wanted = composition.experiment.expect if expect is None else parse_expect(expect)
    check_expect(wanted, composition)
    reason = reader.end_reason or "truncated"
    return judge_blocks(reader.event_blocks(), composition, reason, expect=wanted).checks


def parse_expect(expect: Mapping[str, Any]) -> Mapping[str, AnyExpectation]:
    """The section ``expect`` of an experiment as plain data, checked as far as it can be without one.

    Raises:
        SpecError: a key or value cannot be used.
    """
    try:
        data = plain(expect)
    except ValueError as error:
        raise SpecError(str(error), key="expect") from None
    return validate(_Expected, {"expect": data}, "").expect
