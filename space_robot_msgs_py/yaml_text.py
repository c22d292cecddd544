"""YAML that machines write and anything reads: block style, keys in the order given."""

from __future__ import annotations

import re

import yaml

# PyYAML writes what YAML 1.1 takes for a text without quotes; readers of 1.2, rosbag2 too, take these for numbers.
_NUMBER = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|0o[0-7]+|0x[0-9a-fA-F]+")


class _Dumper(yaml.CSafeDumper):
    """Emits by libyaml, which takes a twelfth of the time of an emitter in Python; writes aliases out."""

    def ignore_aliases(self, data: object) -> bool:
        return True


_Dumper.add_implicit_resolver("tag:yaml.org,2002:float", _NUMBER, list("-+.0123456789"))


def yaml_text(data: object) -> str:
    """YAML in block style, keys in the order given, no line broken."""
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, default_flow_style=False, allow_unicode=True, width=1 << 20)
