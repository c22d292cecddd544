"""Makes a clean, indexed bag of one that was truncated or corrupted, and says what was lost."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

from space_robot_msgs_py.errors import InputFileError, LogError
from space_robot_msgs_py.log.bag import Bag, intact
from space_robot_msgs_py.log.directory import BAG_SUFFIX, METADATA_FILE, write_metadata_yaml
from space_robot_msgs_py.log.mcap.salvage import Damage
from space_robot_msgs_py.log.merge import BagMerger
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.run_directory import RunDirectory

CUT = "cut"


@dataclass(frozen=True, slots=True)
class Recovery:
    """A recovered bag.

    Attributes:
        path: the new bag file.
        kept: messages by topic.
        lost: messages by topic that are known to be missing; of what was behind a cut nothing is known.
        nameless: messages left out because the file no longer says on which topic they were.
        damage: of the old bag.
        last_stamp: log time of the last message [ns].
        end_reason: why the run ended; None: the bag does not say.
        complaint: why the result is a bag but not a run log with its experiment; empty if it is one.
    """

    path: Path
    kept: dict[str, int]
    lost: dict[str, int]
    nameless: int
    damage: tuple[Damage, ...]
    last_stamp: int
    end_reason: str | None
    complaint: str

    @property
    def whole(self) -> bool:
        """Nothing was lost."""
        return not (self.damage or self.lost or self.nameless)


def recover(source: Path | str, target: Path) -> Recovery:
    """Copy what can be read of a bag into a new one; the old one stays as it is.

    Messages keep their bytes and times and are renumbered, because readers take a gap in the numbers for damage.

    Args:
        source: bag directory or .mcap file, of this project or of another tool.
        target: the new bag directory.

    Raises:
        InputFileError: there is no such bag, or it is no MCAP.
        LogError: no message can be recovered, or the target cannot be written; nothing is left of it then.
    """
    bag = Bag(source)
    if not bag.files:
        raise InputFileError(
            "not a bag of plain MCAP files", key=str(source), accepted="*.mcap, not compressed by rosbag2"
        )
    if any(file.resolve().parent == target.resolve() for file in bag.files):
        raise LogError("is the place of the corrupted bag", key=str(target), accepted="another directory")
    merger = BagMerger(bag)
    try:
        # What is in the target stays until there is something better.
        place = target.resolve()
        place.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{place.name}.", dir=place.parent) as scratch:
            draft = Path(scratch) / f"{place.name}{BAG_SUFFIX}"
            reason, complaint = _write(merger, draft, str(source))
            with RunDirectory(target) as locked:
                locked.clear()
                path = locked.bag
                draft.replace(path)
                draft.with_name(METADATA_FILE).replace(path.with_name(METADATA_FILE))
    except LogError:
        raise
    except OSError as error:
        raise LogError(f"cannot be recovered: {error.strerror or error}", key=str(target)) from None
    lost, damage = merger.lost(), tuple(merger.damage)
    return Recovery(path, dict(merger.kept), lost, merger.nameless, damage, merger.last, reason, complaint)


def _write(merger: BagMerger, path: Path, source: str) -> tuple[str | None, str]:
    """Write bag and description; return the reason of the end and why the result is not a run log."""
    merger.write(path)
    if not merger.kept:
        raise LogError("no message can be recovered", key=source)
    reason, complaint = _reread(path, sum(merger.kept.values()))
    custom = {"recovered_from": Path(source).name, "end_reason": reason or CUT}
    span = {"first_stamp": merger.first, "last_stamp": merger.last}
    write_metadata_yaml(path, merger.topics(), custom=custom, **span)
    return reason, complaint


def _reread(path: Path, expected: int) -> tuple[str | None, str]:
    """The reason of the end and why the result is not a run log; a result that cannot be read is an error."""
    found = sum(1 for _ in intact(Bag(path).messages(), str(path)))
    if found != expected:
        raise LogError("the recovered bag does not read back", key=str(path), value=found, accepted=f"{expected}")
    try:
        reader = LogReader(path)
        for _ in reader.messages():
            pass
        return reader.end_reason, ""
    except LogError as error:
        return None, error.message
