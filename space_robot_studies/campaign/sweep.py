"""`space_robot.sweep`: one experiment with some of its values varied, on all cores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp
from typing import TYPE_CHECKING, Any, Literal
from weakref import finalize

from space_robot_bringup.experiment.experiment import Experiment, Overrides
from space_robot_bringup.public.calls import for_python, needing
from space_robot_bringup.public.given import given_experiment
from space_robot_description.frozen import plain
from space_robot_description.load import load_robot
from space_robot_description.validation import validate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.paths import StrPath
from space_robot_studies.campaign.spec import Campaign, with_files
from space_robot_studies.engine.tasks import TIME_LIMIT

if TYPE_CHECKING:
    from space_robot_studies.campaign.campaign import CampaignResult
    from space_robot_studies.engine.hooks import StudyHooks


@for_python
def sweep(
    experiment: StrPath | Experiment,
    vary: Mapping[str, Sequence[Any] | Mapping[str, Any]],
    overrides: Overrides | None = None,
    *,
    runs: int = 1,
    out: StrPath | None = None,
    workers: int | None = None,
    resume: bool = False,
    keep: Literal["failed", "all", "none"] = "none",
    time_limit: float = TIME_LIMIT,
    hooks: StudyHooks | None = None,
) -> CampaignResult:
    """Run an experiment with every combination of some values, on all cores.

    Each case is, to the bit, the ``run`` of the experiment with these values as overrides.

    Args:
        experiment: see ``run``.
        vary: dotted key to its values, ``{"controller.gains.lambda": [0.5, 1.0]}``, or to label and value each; a law
            may be a class of this program. The last key varies fastest.
        overrides: of all cases; see ``run``.
        runs: per combination: with the seed of the experiment and those after it.
        out: directory, see ``campaign``; None: a temporary one, which exists as long as the result.
        workers: worker processes; None: one per core.
        resume: go on with what is in the directory.
        keep: whose bags to keep.
        time_limit: [s] of CPU time of a run; ten times as much may elapse.
        hooks: progress and early end.

    Returns:
        The campaign: ``to_pandas()`` has a row per case, ``groups`` the statistics per combination.

    Raises:
        SpaceRobotError: a case cannot be run, or a package is not installed; nothing was written.
    """
    with needing("sweep", "campaign"):
        from space_robot_studies.campaign.campaign import run_campaign
    spec = with_files(_campaign(given_experiment(experiment, overrides), vary, runs), Path.cwd())
    place = Path(mkdtemp(prefix="space-robot-")) if out is None else Path(out)
    options: dict[str, Any] = {"workers": workers, "resume": resume, "keep": keep, "time_limit": time_limit}
    try:
        done = run_campaign(spec, place, hooks=hooks, **options)
    except BaseException:
        if out is None:
            rmtree(place, ignore_errors=True)
        raise
    if out is None:
        finalize(done, rmtree, place, ignore_errors=True)
    return done


def _campaign(experiment: Experiment, vary: object, runs: int) -> Campaign:
    if not isinstance(vary, Mapping):
        accepted = '{"controller.gains.lambda": [0.5, 1.0]}'
        raise SpecError("not a mapping", key="vary", value=vary, accepted=accepted)
    try:
        varied = plain(vary)
    except ValueError as error:
        raise SpecError(str(error), key="vary") from None
    data = experiment.model_dump(mode="json") | {"robot": dict(load_robot(experiment.robot).resolved)}
    seeds = {"first": experiment.seed, "count": runs}
    said = {"title": experiment.title, "experiment": data, "vary": varied, "seeds": seeds, "runs": runs}
    return validate(Campaign, said, "")
