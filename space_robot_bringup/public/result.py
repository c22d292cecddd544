"""A finished run as one object: verdict, metrics, arrays, table, plot and log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Any

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.metrics import RunMetrics
from space_robot_bringup.judge.remarks import Remark
from space_robot_bringup.modes.run import RunResult
from space_robot_bringup.public.arrays import RunArrays, run_arrays
from space_robot_bringup.public.calls import needing
from space_robot_bringup.public.dataset import dataset
from space_robot_bringup.public.html import run_html
from space_robot_bringup.public.units import units_of
from space_robot_msgs_py.log.reader import LogReader

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

# What draws stands above this package, which must not import it: it is looked up.
FIGURES = "space_robot.figures"


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """What ``space_robot.run`` returns. It stands for its run directory wherever a path is wanted.

    Attributes:
        experiment: what was run, with every default; immutable.
        result: what the run left behind.
        log: reads the log; each call reads it anew. A run directory that is temporary exists as long as this object.
    """

    experiment: Experiment
    result: RunResult
    log: LogReader

    @property
    def directory(self) -> Path:
        """The run directory, a rosbag2 bag."""
        return self.result.directory

    @property
    def reason(self) -> str:
        """Why the run ended: ``completed``, ``interrupted``, ``terminated`` or an error."""
        return self.result.end_reason

    @property
    def passed(self) -> bool | None:
        """Every bound of the verdict holds, one at least of the task.

        None, which is not true either: all that was expected holds, but nothing was expected of the task.
        """
        return self.result.passed

    @property
    def conclusion(self) -> str:
        """The verdict in words: ``PASS``, ``FAIL``, or that the run completed and nothing was expected."""
        return self.result.conclusion

    @property
    def remarks(self) -> tuple[Remark, ...]:
        """What else happened, whatever was expected: limits exceeded, wheels full, commands missed, tumbling."""
        return self.result.remarks

    @property
    def verdict(self) -> tuple[Check, ...]:
        """Bound by bound what was wanted and what was measured; empty if no tick was completed."""
        return self.result.checks

    def expect(self, expect: Mapping[str, Any]) -> tuple[Check, ...]:
        """Assert what the run must show, as in a test: ``run.expect({"base.rate": {"never_above": 0.2}})``.

        Args:
            expect: as the section ``expect`` of an experiment.

        Returns:
            What is expected, check by check, with what the run showed.

        Raises:
            AssertionError: something does not hold or is not judged, one line each.
            SpaceRobotError: a name means nothing in this run.
        """
        # Only here: it composes the experiment in the log, which most results never need.
        from space_robot_bringup.public.judge import judge

        checks = tuple(check for check in judge(self.result.directory, expect) if check.about != "run")
        if lines := [check.line for check in checks if not check.passed]:
            raise AssertionError("\n".join(lines))
        return checks

    @property
    def metrics(self) -> RunMetrics | None:
        """Errors, settling and overshoot by axis, saturation, conservation; None if no tick was completed."""
        return self.result.metrics

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The n joints in the order of every joint array."""
        return self.log.header.joint_names

    @cached_property
    def arrays(self) -> RunArrays:
        """Time, base, joints, reference, command and telemetry as read-only NumPy arrays, read once from the log.

        ``run.arrays.joints.position`` is (K, n) in [rad or m], its columns are ``run.joint_names``; frames, shapes and
        units of all are in ``RunArrays`` and the classes it consists of. A run that completed no tick has no rows.
        """
        return run_arrays(self.log.arrays(), self.joint_names)

    def to_pandas(self) -> pd.DataFrame:
        """Every number of ``arrays`` as one column, by time [s].

        Returns:
            A table of K rows with columns such as ``base.position.x``, ``joints.position.joint1``,
            ``reference.base.quaternion.w``, ``command.effort.joint1`` and ``telemetry.controller.attitude_error.0``.

        Raises:
            SpecError: pandas is not installed.
        """
        with needing("to_pandas", "pandas"):
            import pandas as pd
        index = pd.Index(self.arrays.time, name="time")
        return pd.DataFrame(dict(self.arrays.columns()), index=index)

    def to_xarray(self) -> xr.Dataset:
        """Every array of ``arrays`` by its name, with units and coordinates.

        Returns:
            A Dataset with variables such as ``joints.position`` over the dimensions ``time`` [s] and ``joint``,
            ``base.position`` over ``time`` and ``axis`` and ``base.quaternion`` over ``time`` and ``component``. The
            attribute ``units`` of a variable is its unit. Nothing is copied: the numbers are read-only.

        Raises:
            SpecError: xarray is not installed.
        """
        said = {"title": self._title, "end_reason": self.reason, "seed": str(self.log.header.seed)}
        return dataset(self.arrays, units_of(self.log.header), said)

    def plot(self) -> Any:
        """Draw attitude and joints beside what was desired, and the torques it took.

        Returns:
            A ``matplotlib.figure.Figure`` of pyplot: save it, change it, or show it with ``pyplot.show()``.

        Raises:
            SpecError: matplotlib is not installed.
            LogError: there are fewer than two complete ticks.
        """
        (figure,) = entry_points(group=FIGURES, name="run")
        with needing("plot", "viz"):
            draw = figure.load()
        return draw(self.log)

    def __fspath__(self) -> str:
        """The run directory, so that ``replay(run)`` and ``Path(run)`` work."""
        return str(self.directory)

    def __repr__(self) -> str:
        ticks = self.metrics.ticks if self.metrics else 0
        return f"<Run {self._title!r}: {self.conclusion} ({self.reason}), {ticks} ticks, {self.directory}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the verdict and the axes as tables."""
        return run_html(self._title, self.result)

    @property
    def _title(self) -> str:
        return self.experiment.title or self.experiment.controller.law
