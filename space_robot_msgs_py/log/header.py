"""What a log says about itself before its first message."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.limits import JOINTS, LAW_SOURCE_BYTES, NAME_LENGTH, URDF_BYTES, YAML_BYTES, Limit

METADATA_NAME = "space_robot"
EXPERIMENT_ATTACHMENT = "experiment.yaml"
URDF_ATTACHMENT = "robot.urdf"


@dataclass(frozen=True, slots=True)
class LawSource:
    """The file of a custom law, to be read and compared; a log never runs it.

    Attributes:
        class_name: of the law in that file.
        digest: SHA-256 of the file.
        text: of the file; empty where it is no text.
    """

    class_name: str
    digest: str
    text: str


@dataclass(frozen=True, slots=True)
class LogHeader:
    """Provenance: with it a log replays without any other file.

    Attributes:
        experiment: the resolved experiment as YAML.
        urdf: the nominal robot.
        seed: of the run.
        joint_names: the robot's joints in model order.
        versions: package name to version, of everything that can change the bits of a run.
        laws: name in the experiment to the source of a custom law; the versions identify shipped ones.
        topics: names of the optional topics that the log has channels of.
    """

    experiment: str
    urdf: str
    seed: int
    joint_names: tuple[str, ...]
    versions: dict[str, str] = field(default_factory=dict)
    laws: Mapping[str, LawSource] = field(default_factory=dict)
    topics: tuple[str, ...] = ()

    def metadata(self) -> dict[str, str]:
        """What goes into the metadata record; experiment, URDF and sources are attachments."""
        entries = {
            "seed": str(self.seed),
            "joint_names": json.dumps(self.joint_names),
            "versions": json.dumps(self.versions, sort_keys=True),
        }
        if self.topics:
            entries["topics"] = json.dumps(self.topics)
        if not self.laws:
            return entries
        said = {
            name: {"class": law.class_name, "sha256": law.digest, "attachment": law_attachment(index)}
            for index, (name, law) in enumerate(self.laws.items())
        }
        return entries | {"laws": json.dumps(said)}

    def attachments(self) -> list[tuple[str, str, str]]:
        """Name, media type and text of everything that is attached."""
        texts = [(law_attachment(index), law.text) for index, law in enumerate(self.laws.values())]
        return [
            (EXPERIMENT_ATTACHMENT, "application/yaml", self.experiment),
            (URDF_ATTACHMENT, "application/xml", self.urdf),
            *((name, "text/x-python", text) for name, text in texts if text),
        ]

    @classmethod
    def of(cls, metadata: Mapping[str, str], attachments: Mapping[str, bytes], key: str) -> LogHeader:
        """The header from the records of a file.

        Args:
            metadata: of the record ``space_robot``.
            attachments: content by name.
            key: the file, for error messages.

        Raises:
            LogError: something is missing or unreadable.
        """
        try:
            return cls(
                _text(attachments[EXPERIMENT_ATTACHMENT], YAML_BYTES, key),
                _text(attachments[URDF_ATTACHMENT], URDF_BYTES, key),
                int(metadata["seed"]),
                _names(json.loads(metadata["joint_names"])),
                {str(name): str(version) for name, version in json.loads(metadata["versions"]).items()},
                _laws(json.loads(metadata.get("laws", "{}")), attachments, key),
                _names(json.loads(metadata.get("topics", "[]"))),
            )
        except LogError:
            raise
        except UnicodeDecodeError as error:
            # Its own text would quote the whole attachment.
            raise LogError(f"its header is damaged: {error.reason} at byte {error.start}", key=key) from None
        except (LookupError, ValueError, TypeError, AttributeError, RecursionError) as error:
            raise LogError(f"its header is incomplete or damaged: {error!r}", key=key) from None


def law_attachment(index: int) -> str:
    """What the source of a custom law is called in a log."""
    return f"law_{index}.py"


def _text(data: bytes, limit: Limit, key: str) -> str:
    limit.check(len(data), key, LogError)
    return data.decode()


def _names(found: object) -> tuple[str, ...]:
    """Names of joints as messages can hold them.

    Raises:
        ValueError: they cannot be.
    """
    if not isinstance(found, list) or not all(isinstance(name, str) and "\0" not in name for name in found):
        raise ValueError("joint_names are no list of texts")
    if len(set(found)) != len(found) or len(found) > JOINTS.most:
        raise ValueError(f"{len(found)} joint_names, some twice or more than {JOINTS.most}")
    if any(len(name.encode()) > NAME_LENGTH.most for name in found):
        raise ValueError(f"a joint name of more than {NAME_LENGTH.most} {NAME_LENGTH.unit}")
    return tuple(found)


def _laws(said: Mapping[str, Any], attachments: Mapping[str, bytes], key: str) -> dict[str, LawSource]:
    laws = {}
    for name, law in said.items():
        text = _text(attachments.get(law["attachment"], b""), LAW_SOURCE_BYTES, key)
        laws[str(name)] = LawSource(str(law["class"]), str(law["sha256"]), text)
    return laws
