"""`space_robot.run`: an experiment in, a finished run out."""

from __future__ import annotations

import warnings
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp
from weakref import finalize

from space_robot_bringup.experiment.experiment import Experiment, Overrides, with_changes
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.run import Mode, run_experiment
from space_robot_bringup.public.calls import for_python
from space_robot_bringup.public.given import given_experiment
from space_robot_bringup.public.result import Run
from space_robot_msgs_py.errors import SpaceRobotWarning
from space_robot_msgs_py.log.free_directory import checked_directory
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.paths import StrPath


@for_python
def run(
    experiment: StrPath | Experiment,
    overrides: Overrides | None = None,
    *,
    mode: Mode = "headless",
    out: StrPath | None = None,
    overwrite: bool = False,
    duration: float | None = None,
    realtime: float | None = None,
    hooks: Hooks | None = None,
) -> Run:
    """Run an experiment and judge it; the same experiment and seed give the same log, bit for bit, in every mode.

    The first run after an installation compiles the plant and the law, which takes about half a minute.

    Args:
        experiment: a shipped name such as ``liu2023/fig08``, the path of a YAML file, or a loaded experiment.
        overrides: ``{"controller.gains.lambda": 0.7}``, or ``["controller.gains.lambda=0.7"]`` with values in YAML.
        mode: ``headless`` (one loop), ``graph`` (ROS 2 nodes in this process) or ``processes`` (one process per node).
        out: run directory. None: a temporary one, which exists as long as the ``log`` of the result.
        overwrite: a run that is in the run directory is replaced.
        duration: run this long instead [s].
        realtime: simulated seconds per second, in ``graph`` and ``processes``; None: as fast as possible.
        hooks: progress and early end.

    Returns:
        The run. One that ends early, or misses its verdict, is a result and not an exception: see ``Run.reason``.

    Raises:
        SpaceRobotError: the experiment or an argument cannot be used, a run is in ``out`` already, or the log cannot be
            written; nothing was run.

    Warns:
        SpaceRobotWarning: the run lies outside the bounds of its law.
    """
    spec = given_experiment(experiment, overrides)
    if duration is not None:
        spec = with_changes(spec, {"duration": duration})
    given = None if out is None else checked_directory(Path(out), overwrite=overwrite, key="out")
    place = (Path(mkdtemp(prefix="space-robot-")) if given is None else given).absolute()
    said: list[str] = []
    try:
        result = run_experiment(spec, place, mode=mode, realtime=realtime, hooks=hooks or Hooks(warn=said.append))
        log = LogReader(result.directory.resolve())
    except BaseException:
        if out is None:
            rmtree(place, ignore_errors=True)
        raise
    if out is None:
        finalize(log, rmtree, place, ignore_errors=True)
    for warning in said:
        warnings.warn(warning, SpaceRobotWarning, stacklevel=3)
    return Run(spec, result, log)
