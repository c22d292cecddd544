"""Reference bags made new: the same experiment run again, the bag replaced only when the new one is on the disk."""

from __future__ import annotations

import tempfile
from pathlib import Path

from space_robot_bringup.modes import headless
from space_robot_bringup.replay.controller_events import Repeated, RepeatedOrders
from space_robot_bringup.replay.recording import Recording
from space_robot_control.references.recorded import Recorded
from space_robot_msgs_py.codec.codecs import decode_events, decode_statuses
from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.interfaces import ReferenceSource
from space_robot_msgs_py.log.bag import Bag
from space_robot_msgs_py.log.directory import BAG_SUFFIX, METADATA_FILE
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink
from space_robot_msgs_py.topics import CONTROLLER_EVENTS, EVENTS
from space_robot_supervisor.reports import orders_in

_HEADLESS = {"mode": "headless"}


def update_reference(recording: Recording) -> bool:
    """Run the experiment of a log again, headless, and put the new bag in its place.

    Args:
        recording: with what was overridden, which becomes part of the new reference.

    Returns:
        True if the file is another one than before.

    Raises:
        LogError: it is not a run log, the new run ends otherwise, or the disk refuses; the bag is as it was.
    """
    old = _bag_file(recording)
    composition = recording.composition
    try:
        with tempfile.TemporaryDirectory(prefix=f".{old.parent.name}.", dir=old.parent) as scratch:
            sink = LogSink(Path(scratch) / old.name.removesuffix(BAG_SUFFIX), composition.header, custom=_HEADLESS)
            controller = Repeated(composition.controller(), _events(recording))
            parts = composition.plant(), controller, _reference(recording)
            steps, watch = composition.experiment.steps, composition.supervisor()
            supervisor = None if watch is None else RepeatedOrders(watch, _orders(recording))
            reason = headless.run(*parts, steps=steps, sink=sink, supervisor=supervisor)
            if reason not in ("completed", recording.end_reason):
                raise LogError(f"the new run ends otherwise: {reason}", key=str(old), accepted="the old bag stays")
            return _replace(old, sink.writer.path)
    except LogError:
        raise
    except OSError as error:
        raise LogError(f"cannot be replaced: {error.strerror or error}", key=str(old)) from None


def _events(recording: Recording) -> dict[int, tuple[ControllerEvent, ...]]:
    """Recorded changes belong to the run, and are applied in the new one too."""
    rows = ((stamp, parts.get(CONTROLLER_EVENTS.name)) for stamp, parts in recording.rows())
    return {stamp: decode_events(raw) for stamp, raw in rows if raw is not None}


def _reference(recording: Recording) -> ReferenceSource:
    """What set-points from outside made of the reference belongs to the run, too."""
    if recording.composition.experiment.reference.kind != "live":
        return recording.composition.reference()
    arrays = LogReader(recording.path).arrays()
    return Recorded.from_arrays(arrays.stamp.tolist(), arrays.q_d, arrays.v_d, arrays.a_d)


def _orders(recording: Recording) -> dict[int, list[str]]:
    """So do the commands of the ground."""
    rows = ((stamp, parts.get(EVENTS.name)) for stamp, parts in recording.rows())
    return {stamp: orders_in(decode_statuses(raw)) for stamp, raw in rows if raw is not None}


def _bag_file(recording: Recording) -> Path:
    files = Bag(recording.path).files
    if recording.foreign or len(files) != 1 or not files[0].name.endswith(BAG_SUFFIX):
        accepted = f"a run log, <name>{BAG_SUFFIX} in its run directory"
        raise LogError("is no reference that could be run again", key=str(recording.path), accepted=accepted)
    return files[0].resolve()


def _replace(old: Path, new: Path) -> bool:
    if old.read_bytes() == new.read_bytes():
        return False
    # The description goes first and comes last: a kill in between must not leave one that describes another bag.
    described = old.with_name(METADATA_FILE)
    described.unlink(missing_ok=True)
    new.replace(old)
    new.with_name(METADATA_FILE).replace(described)
    return True
