"""A bag of another tool to be looked at: its states, whatever else of a run is in it, and no verdict."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.logs.assessed import JudgedLog, read_judged
from space_robot_bringup.logs.foreign_bag import PLAIN, Source, foreign_rows, names_and_urdf
from space_robot_bringup.logs.happened import Witness
from space_robot_bringup.logs.logged import compose_logged
from space_robot_bringup.logs.relaxed import relaxed
from space_robot_description.model import build_model
from space_robot_description.urdf import parse_urdf
from space_robot_msgs_py.codec.cdr import with_stamp
from space_robot_msgs_py.codec.codecs import CommandCodec, ReferenceCodec, StateCodec
from space_robot_msgs_py.codec.values import PartsCodec
from space_robot_msgs_py.errors import InputFileError, LogError, SpaceRobotError
from space_robot_msgs_py.interfaces import NANOSECONDS, Command, Reference, ReferenceSource, RobotState
from space_robot_msgs_py.log.arrays import Row
from space_robot_msgs_py.log.bag import Bag
from space_robot_msgs_py.log.blocks import BlockStacker
from space_robot_msgs_py.log.header import LogHeader
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.thinning import Thinner
from space_robot_msgs_py.paths import StrPath
from space_robot_msgs_py.topics import BASE_IMU, BASE_ODOM, JOINT_STATES, ROBOT_DESCRIPTION

REFERENCE, COMMAND = "reference", "command"
ENDED = "not known, a bag of another tool"


def read_shown(path: StrPath, experiment: StrPath | None = None, source: Source = PLAIN) -> JudgedLog:
    """A run log, whole or corrupted, or a bag of another tool, to be looked at.

    Args:
        path: run directory, bag directory or one of its files.
        experiment: shipped name or YAML file that says what such a bag lacks: its robot, its reference.
        source: where the topics are in such a bag.

    Raises:
        InputFileError: there is no such bag.
        LogError: nothing in it can be shown.
        SpecError: its robot, or the experiment, cannot be used.
    """
    if experiment is None:
        try:
            LogReader(path)
        except (InputFileError, LogError) as error:
            try:
                Bag(Path(path))
            except InputFileError:
                raise error from None
            return read_foreign(path, None, source, f" ({error.message})")
        return read_judged(path)
    return read_foreign(path, experiment, source)


def read_foreign(path: StrPath, experiment: StrPath | None = None, source: Source = PLAIN, why: str = "") -> JudgedLog:
    """What a bag of another tool shows; see ``read_shown``.

    Joints that come at other times than the base stand as they were last; so do references and commands. ``why`` it is
    read so is said with it.
    """
    bag = Bag(Path(path))
    composition = compose_logged(load_experiment(experiment)) if experiment is not None else None
    urdf, joints = _robot(bag, composition, source)
    found, remarks = foreign_rows(bag, joints, source)
    filled = _Filled(joints, composition)
    witness = Witness(filled.rows(found))
    thinner, unfit = _thinned(witness.rows(), joints, str(path))
    arrays = thinner.arrays()
    if arrays is None:
        reason = [*unfit, *remarks, f"no stamp with {BASE_ODOM.name} and {JOINT_STATES.name}"][0]
        raise LogError(f"no state can be shown: {reason}", key=str(path), accepted=f"a joint state of {joints}")
    said = [*remarks, *unfit[:3], *_more(unfit[3:]), *filled.remarks()]
    return JudgedLog(
        path=Path(path),
        header=LogHeader("", urdf, 0, joints),
        mode="",
        end_reason=ENDED,
        ticks=thinner.ticks,
        arrays=arrays,
        experiment=None,
        composition=composition,
        metrics=None,
        checks=(),
        remarks=(),
        events=(),
        happened=tuple(witness.events),
        troubles=(f"no verdict: a bag of another tool{why}", *said),
        absent=filled.absent(),
    )


def _robot(bag: Bag, composition: Composition | None, source: Source) -> tuple[str, tuple[str, ...]]:
    """The URDF of a bag and its joints in model order, of the bag or of the experiment that was given."""
    _, urdf = names_and_urdf(bag, source)
    urdf = urdf or (composition.nominal.urdf if composition is not None else "")
    if not urdf:
        accepted = f"a message on {source.name(ROBOT_DESCRIPTION)}, or --experiment FILE"
        raise LogError("no robot in it", key=str(bag.path), accepted=accepted)
    return urdf, composition.joint_names if composition is not None else _joints(urdf)


def _thinned(rows: Iterator[Row], joints: Sequence[str], key: str) -> tuple[Thinner, list[str]]:
    """The ticks that fit the robot, and why others do not, a line each."""
    thinner, unfit = Thinner(), list[str]()
    for block in BlockStacker(joints, key).blocks(rows):
        unfit += [f"tick at {stamp / NANOSECONDS:g} s left out: {error}" for stamp, error in block.unfit]
        if block.arrays is not None:
            thinner.add(block.arrays)
    return thinner, unfit


def _joints(urdf: str) -> tuple[str, ...]:
    """The moving joints of a robot, in model order."""
    _, rows = build_model(parse_urdf(urdf, ROBOT_DESCRIPTION.name))
    return tuple(rows)


def _more(left: Sequence[str]) -> list[str]:
    return [f"{len(left)} more ticks left out"] if left else []


class _Filled:
    """Completes the ticks of a bag, as a log has them: with what was last, with the experiment, or with nothing.

    Args:
        joints: names of the joints in model order.
        composition: of the experiment that was given, whose reference it is.
    """

    def __init__(self, joints: Sequence[str], composition: Composition | None) -> None:
        self._state, self._reference, self._command = StateCodec(joints), ReferenceCodec(joints), CommandCodec(joints)
        self._desired: ReferenceSource | None = composition.reference() if composition is not None else None
        self._count = len(joints)
        self._last: dict[str, bytes] = {}
        self._heard: set[str] = set()
        self._late = self._relaxed = 0

    def absent(self) -> frozenset[str]:
        """Kinds of which the bag has nothing: the reference is then the state, the command zero."""
        known = self._heard | ({REFERENCE} if self._desired is not None else set())
        return frozenset((REFERENCE, COMMAND)) - known

    def remarks(self) -> list[str]:
        """What a reader should know, a line each."""
        said = [f"no {kind} in the bag" for kind in sorted(self.absent())]
        if self._late:
            said.append(f"joints of {self._late} ticks are those of an earlier stamp")
        if self._relaxed:
            said.append(
                f"{self._relaxed} states have other frames, or joints without velocity and effort: poses are drawn"
            )
        if self._desired is not None and REFERENCE not in self._heard:
            said.append("desired: by the experiment that was given, not by the bag")
        return said

    def rows(self, rows: Sequence[Row]) -> Iterator[Row]:
        """Every stamp with a base, once the joints are known, as a complete tick."""
        for stamp, parts in rows:
            self._last |= parts
            if BASE_ODOM.name not in parts or JOINT_STATES.name not in self._last:
                continue
            self._late += JOINT_STATES.name not in parts
            held = parts | {JOINT_STATES.name: with_stamp(self._last[JOINT_STATES.name], stamp)}
            try:
                yield stamp, self._complete(stamp, held)
            except SpaceRobotError:
                # It does not fit the robot: the stacker says why.
                yield stamp, held | self._nothing(stamp)

    def _complete(self, stamp: int, parts: dict[str, bytes]) -> dict[str, bytes]:
        n = self._count
        still = RobotState(stamp, np.eye(1, 7 + n, 6)[0], np.zeros(6 + n), np.zeros(n), np.zeros(3))
        parts.setdefault(BASE_IMU.name, self._state.encode(still)[2])
        state = self._state_of(parts)
        at_rest = Reference(stamp, state.q, np.zeros(6 + n), np.zeros(6 + n))
        desired = self._desired.at(stamp) if self._desired is not None else at_rest
        idle = Command(stamp, np.zeros(6), np.zeros(n))
        parts |= self._held(REFERENCE, self._reference, stamp) or _named(
            self._reference, self._reference.encode(desired)
        )
        parts |= self._held(COMMAND, self._command, stamp) or _named(self._command, self._command.encode(idle))
        return parts

    def _state_of(self, parts: dict[str, bytes]) -> RobotState:
        """The state in these parts, which are put right as far as a drawing needs them."""
        try:
            return self._state.decode([parts[topic.name] for topic in self._state.topics])
        except SpaceRobotError:
            parts |= {topic.name: relaxed(topic, parts[topic.name]) for topic in self._state.topics}
            self._relaxed += 1
            return self._state.decode([parts[topic.name] for topic in self._state.topics])

    def _held(self, kind: str, codec: PartsCodec[Reference] | PartsCodec[Command], stamp: int) -> dict[str, bytes]:
        """The last parts of a kind, as of this stamp [ns]; nothing where one of them has not been."""
        names = [topic.name for topic in codec.topics]
        if any(name not in self._last for name in names):
            return {}
        self._heard.add(kind)
        return {name: with_stamp(self._last[name], stamp) for name in names}

    def _nothing(self, stamp: int) -> dict[str, bytes]:
        """Commands and references of a tick whose state cannot be used."""
        n = self._count
        zero = Reference(stamp, np.eye(1, 7 + n, 6)[0], np.zeros(6 + n), np.zeros(6 + n))
        command = self._command.encode(Command(stamp, np.zeros(6), np.zeros(n)))
        return _named(self._reference, self._reference.encode(zero)) | _named(self._command, command)


def _named(codec: PartsCodec[Reference] | PartsCodec[Command], parts: Sequence[bytes]) -> dict[str, bytes]:
    return {topic.name: part for topic, part in zip(codec.topics, parts, strict=True)}
