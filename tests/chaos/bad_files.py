"""Files that are nearly right: changed texts, descriptions with parts displaced, damaged logs."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from random import Random

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, Metadata, Schema

from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_description.validation import parse_yaml_text
from space_robot_msgs_py.escapes import visible
from space_robot_msgs_py.log.mcap.records import MAGIC, MESSAGE, message_bytes, record_bytes, scan
from tests.chaos.nasty import VALUES, changed_bytes, changed_text, changed_tree
from tests.support.bombs import BAD_YAML


@dataclass(frozen=True)
class Bags:
    """Bags of one short run, made once.

    Attributes:
        closed: the file as it is at the end of a run.
        running: the file as a kill leaves it.
        folder: where both run directories are.
    """

    closed: bytes
    running: bytes
    folder: Path


def bad_yaml(text: str, random: Random) -> str:
    draw = random.random()
    if draw < 0.05:
        return text + "\n" + random.choice(list(BAD_YAML.values()))[0]
    if draw < 0.45:
        return changed_text(text, random)
    data = changed_tree(parse_yaml_text(text, "shipped"), random, random.choice((1, 1, 2, 5)))
    return dump_yaml(data) if isinstance(data, dict) else str(data)


def changed_xml(text: str, random: Random) -> str:
    """Values of attributes replaced, elements dropped, doubled, moved or nested."""
    from xml.etree import ElementTree as ET

    root = ET.fromstring(text)
    for _ in range(random.choice((1, 1, 3))):
        elements = list(root.iter())
        chosen, other = random.choice(elements), random.choice(elements)
        match random.randrange(5):
            case 0 if chosen.attrib:
                value = random.choice((*map(str, VALUES), "0 0", "1 2 3 4", "nan 0 0", "1e999 0 0", "0 0 0"))
                chosen.set(random.choice(list(chosen.attrib)), visible(value))
            case 1 if len(other):
                other.remove(random.choice(list(other)))
            case 2 if chosen is not root and chosen not in other.iter() and other not in chosen.iter():
                other.append(chosen)
            case 3:
                chosen.tag = random.choice(("link", "joint", "mesh", "robot", "origin", "inertial", "gazebo"))
            case _:
                chosen.attrib = dict(other.attrib)
    return ET.tostring(root, encoding="unicode")


def bad_log(random: Random, bags: Bags) -> bytes:
    draw = random.random()
    if draw < 0.3:
        return changed_bytes(bags.closed, random)
    if draw < 0.55:
        return changed_bytes(bags.running, random)
    return _forged(random, bags)


def _forged(random: Random, bags: Bags) -> bytes:
    """A log whose records are whole, with values that no writer makes."""
    stream = BytesIO(bags.running)
    stream.seek(len(MAGIC))
    records = [(opcode, content) for opcode, content in scan(stream, len(bags.running))]
    out, forge = [MAGIC], random.choice(("experiment", "experiment", "urdf", "header", "message", "chunk", "order"))
    for opcode, content in records:
        if opcode == Opcode.ATTACHMENT and forge in ("experiment", "urdf"):
            out.append(_forged_attachment(content, forge, random))
        elif opcode == Opcode.METADATA and forge == "header":
            out.append(_forged_metadata(content, random))
        elif opcode == Opcode.MESSAGE and forge == "message" and random.random() < 0.1:
            channel, sequence, stamp, _ = MESSAGE.unpack_from(content)
            stamp = random.choice((stamp, stamp, 0, 2**63, 1))
            out.append(message_bytes(channel, sequence, stamp, changed_bytes(content[MESSAGE.size :], random)))
        else:
            out.append(struct.pack("<BQ", opcode, len(content)) + content)
    if forge == "order":
        random.shuffle(out)
        out.insert(0, MAGIC)
    if forge == "chunk":
        size = random.choice((0, 10, 2**20, 2**34, 2**63))
        chunk = Chunk(random.choice(("zstd", "lz4", "", "x")), random.randbytes(50), 0, 0, 0, size)
        out.insert(random.randrange(1, len(out)), record_bytes(chunk))
        out.append(record_bytes(Schema(id=1, data=b"x", encoding="ros2msg", name="std_msgs/msg/String")))
        out.append(record_bytes(Channel(id=1, topic="/\x1b[31m", message_encoding="cdr", metadata={}, schema_id=9)))
    return b"".join(out)


def _forged_attachment(content: bytes, forge: str, random: Random) -> bytes:

    attachment: Attachment = Attachment.read(ReadDataStream(BytesIO(content)))
    text = attachment.data.decode()
    if forge == "experiment" and attachment.name == "experiment.yaml":
        text = bad_yaml(text, random)
    elif forge == "urdf" and attachment.name == "robot.urdf":
        text = changed_xml(text, random)
    return record_bytes(replace(attachment, data=text.encode("utf-8", "surrogatepass")))


def _forged_metadata(content: bytes, random: Random) -> bytes:

    metadata: Metadata = Metadata.read(ReadDataStream(BytesIO(content)))
    entries = dict(metadata.metadata)
    for name in list(entries):
        if random.random() < 0.5:
            value = changed_tree(random.choice(([], ["joint1", "joint2"], {"a": "b"}, 3, "x")), random)
            entries[name] = json.dumps(value, default=str)
    return record_bytes(Metadata(name=metadata.name, metadata=entries))
