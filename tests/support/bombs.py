"""Texts that are too large, too deep or without an end, and what is said of each."""

from __future__ import annotations

from itertools import pairwise

LETTERS = "abcdefghijklmnop"


def alias_bomb() -> str:
    """Fewer than 900 bytes that are 9^16 values."""
    lines = [f"a: &a [{', '.join(['x'] * 9)}]"]
    for old, new in pairwise(LETTERS):
        lines.append(f"{new}: &{new} [{', '.join([f'*{old}'] * 9)}]")
    return "\n".join(lines)


def merge_bomb() -> str:
    """Mappings that merge nine of the one before."""
    lines = ["a: &a {k: 1}"]
    for old, new in pairwise(LETTERS):
        lines.append(f"{new}: &{new} {{<<: [{', '.join([f'*{old}'] * 9)}], k{new}: 1}}")
    return "\n".join(lines)


BAD_YAML = {
    "aliases to aliases": (alias_bomb(), "YAML_NODES"),
    "merges of merges": (merge_bomb(), "YAML_NODES"),
    "an alias to itself": ("a: &a [*a]", "part of"),
    "a mapping in itself": ("a: &a {b: {c: *a}}", "part of"),
    "deep lists": ("a: " + "[" * 3000 + "]" * 3000, "YAML_DEPTH"),
    "an integer without end": ("a: 1" + "0" * 400, "INTEGER_BITS"),
    "an integer of hexadecimal digits": ("a: 0x" + "f" * 100_000, "INTEGER_BITS"),
    "a NUL": ('a: "x\\0y"', "NUL"),
    "a key twice beside a merge": ("m: &m {x: 1}\na: {<<: *m, y: 1, y: 2}", 'duplicate key "y"'),
    "a Python object": ("a: !!python/object/apply:os.system [id]", "tag"),
    "a set": ("a: !!set {x}", "tag"),
    "a date": ("a: 2026-01-02", "date"),
    "a list for a key": ("? [1, 2]\n: 3", "key"),
    "infinity": ("a: {b: [1, .inf]}", "a.b.1"),
    "not a number": ("a: !!float .nan", "not a finite number"),
    "a number beyond all": ("a: 1e999", "not a finite number"),
}
ENTITIES = "".join(f'<!ENTITY e{i} "{f"&e{i - 1};" * 10 if i else "ha"}">' for i in range(12))
BAD_XML = {
    "entities of entities": (f"<!DOCTYPE robot [{ENTITIES}]><robot name='&e11;'/>", "document type"),
    "another file": ("<!DOCTYPE robot [<!ENTITY x SYSTEM 'file:///etc/passwd'>]><robot name='&x;'/>", "document type"),
    "a type elsewhere": ("<!DOCTYPE robot SYSTEM 'http://localhost:9/x.dtd'><robot/>", "document type"),
    "deep elements": ("<robot name='r'>" + "<link>" * 3000 + "</link>" * 3000 + "</robot>", "URDF_DEPTH"),
    "many elements": ("<robot name='r'>" + "<link/>" * 100_001 + "</robot>", "URDF_ELEMENTS"),
    "a long text": ("<robot name='r'>" + " " * 9_000_000 + "</robot>", "URDF_BYTES"),
    "a long name": (f"<robot name='r'><link name='{'x' * 257}'/></robot>", "NAME_LENGTH"),
    "many joints": ("<robot name='r'>" + "".join(f"<joint name='j{i}'/>" for i in range(1001)) + "</robot>", "JOINTS"),
}
