"""How large anything that comes in may be, and why: the one place with such numbers.

Nothing here limits what is useful; everything here ends what would fill the memory or take for ever. Errors name the
limit, and docs/limits.md has the table.
"""

from __future__ import annotations

from dataclasses import dataclass

from space_robot_msgs_py.errors import SpaceRobotError, SpecError

KIB, MIB = 1 << 10, 1 << 20


@dataclass(frozen=True, slots=True)
class Limit:
    """One bound on what comes in.

    Attributes:
        name: as errors and docs call it.
        most: the largest number that is accepted.
        unit: of the number.
        why: the reason for this number.
    """

    name: str
    most: int
    unit: str
    why: str

    def check(self, found: int, key: str, error: type[SpaceRobotError] = SpecError) -> None:
        """Refuse what is larger.

        Args:
            found: how large it is.
            key: what is too large, for the error.
            error: its class.

        Raises:
            SpaceRobotError: of the class given.
        """
        if found > self.most:
            raise self.exceeded(key, found, error)

    def exceeded(self, key: str, found: int | None = None, error: type[SpaceRobotError] = SpecError) -> SpaceRobotError:
        """The error that says so; ``found`` None: it was not counted to its end."""
        value = None if found is None else f"{found} {self.unit}"
        return error(f"too large (limit {self.name})", key=key, value=value, accepted=f"up to {self.most} {self.unit}")


YAML_BYTES = Limit(
    "YAML_BYTES", 16 * MIB, "bytes", "the resolved experiment of a long recorded reference; parsing takes 1 s per MiB"
)
YAML_NODES = Limit(
    "YAML_NODES",
    400_000,
    "values, aliases written out",
    "a recorded reference of 10,000 ticks; 13,000 are parsed per second, and every reader walks them all",
)
YAML_DEPTH = Limit("YAML_DEPTH", 64, "levels", "the deepest shipped file has 8; deeper ones exhaust Python's stack")
INTEGER_BITS = Limit("INTEGER_BITS", 128, "bits", "a seed of NumPy has 128; Python prints none beyond 4,300 digits")
TITLE_LENGTH = Limit("TITLE_LENGTH", 1_000, "characters", "a title is one line in a table, a page and a picture")
TEXT_LENGTH = Limit("TEXT_LENGTH", 20_000, "characters", "the longest caption and note of a paper's manifest")
NAME_LENGTH = Limit("NAME_LENGTH", 256, "bytes", "joints and links: the names stand in every message and every table")
METADATA_BYTES = Limit("METADATA_BYTES", MIB, "bytes", "metadata.yaml of a bag of 1,000 topics")

URDF_BYTES = Limit("URDF_BYTES", 8 * MIB, "bytes", "a hundred times the largest shipped robot; meshes are not in it")
URDF_ELEMENTS = Limit("URDF_ELEMENTS", 100_000, "elements", "a robot of 1,000 links with ten visuals each")
URDF_DEPTH = Limit("URDF_DEPTH", 64, "levels", "URDF has 5, extensions some more; writing it again recurses")
JOINTS = Limit("JOINTS", 1_000, "joints", "every message of a tick holds all of them")
MESH_BYTES = Limit("MESH_BYTES", 64 * MIB, "bytes", "it is drawn with 2,500 triangles")

RECORD_BYTES = Limit("RECORD_BYTES", 256 * MIB, "bytes", "a chunk of a bag with images; a record is held in memory")
CHUNK_BYTES = Limit("CHUNK_BYTES", 256 * MIB, "bytes", "unpacked, it is held in memory as a whole")
DAMAGES = Limit("DAMAGES", 1_000, "damaged places", "beyond, nothing of the rest can be trusted to be a record")
MESSAGE_SLACK = Limit(
    "MESSAGE_SLACK",
    64 * KIB,
    "bytes beyond the message of this robot",
    "its size is known from the joint names; other frame names and further fields fit in",
)
STATE_BYTES = Limit("STATE_BYTES", 512 * KIB, "bytes", "joint_states of 1,000 joints with the longest names")
TELEMETRY_BYTES = Limit("TELEMETRY_BYTES", MIB, "bytes", "130,000 numbers per tick")
TELEMETRY_BLOCKS = Limit("TELEMETRY_BLOCKS", 1_000, "blocks", "each has a layout of its own to be found, and a plot")
STRING_BYTES = Limit("STRING_BYTES", URDF_BYTES.most + KIB, "bytes", "the longest text on a topic is a URDF")
REASON_BYTES = Limit("REASON_BYTES", 64 * KIB, "bytes", "why a run ended, one line: an error with what it quotes")
EVENT_BYTES = Limit("EVENT_BYTES", MIB, "bytes", "all gains of all laws of a run, changed at once")

LAW_SOURCE_BYTES = Limit("LAW_SOURCE_BYTES", MIB, "bytes", "a law is one file of Python text; the log carries it")
ROW_BYTES = Limit("ROW_BYTES", MIB, "bytes", "one case of a campaign: its numbers, and a traceback if it failed")
ROWS_BYTES = Limit("ROWS_BYTES", 1024 * MIB, "bytes", "100,000 cases of 10 kB, which is what a campaign may have")

LIMITS: tuple[Limit, ...] = tuple(value for value in globals().values() if isinstance(value, Limit))
