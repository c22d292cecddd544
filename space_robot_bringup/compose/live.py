"""The reference of a run that set-points from outside move."""

from __future__ import annotations

from space_robot_bringup.compose.composition import Composition
from space_robot_control.references.live import LiveReference
from space_robot_control.references.spec import LiveSpec


def live_reference(composition: Composition) -> LiveReference | None:
    """A new one, at rest where the run starts; None: the references of the run are known before it."""
    experiment = composition.experiment
    if not isinstance(experiment.reference, LiveSpec):
        return None
    timing = {"period": experiment.period, "steps": experiment.steps}
    return LiveReference(experiment.reference, composition.nominal, composition.initial[0], **timing)
