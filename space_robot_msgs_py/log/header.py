"""What a log says about itself before its first message."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field

from space_robot_msgs_py.errors import LogError

METADATA_NAME = "space_robot"
EXPERIMENT_ATTACHMENT = "experiment.yaml"
URDF_ATTACHMENT = "robot.urdf"


@dataclass(frozen=True, slots=True)
class LogHeader:
    """Provenance: with it a log replays without any other file.

    Attributes:
        experiment: the resolved experiment as YAML.
        urdf: the nominal robot.
        seed: of the run.
        joint_names: the robot's joints in model order.
        versions: package name to version, of everything that can change the bits of a run.
    """

    experiment: str
    urdf: str
    seed: int
    joint_names: tuple[str, ...]
    versions: dict[str, str] = field(default_factory=dict)

    def metadata(self) -> dict[str, str]:
        """What goes into the metadata record; experiment and URDF are attachments."""
        return {
            "seed": str(self.seed),
            "joint_names": json.dumps(self.joint_names),
            "versions": json.dumps(self.versions, sort_keys=True),
        }

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
                attachments[EXPERIMENT_ATTACHMENT].decode(),
                attachments[URDF_ATTACHMENT].decode(),
                int(metadata["seed"]),
                tuple(json.loads(metadata["joint_names"])),
                dict(json.loads(metadata["versions"])),
            )
        except UnicodeDecodeError as error:
            # Its own text would quote the whole attachment.
            raise LogError(f"its header is damaged: {error.reason} at byte {error.start}", key=key) from None
        except (KeyError, ValueError, TypeError) as error:
            raise LogError(f"its header is incomplete or damaged: {error!r}", key=key) from None
