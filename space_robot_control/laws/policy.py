"""Whose code may become a law: data never brings any, only what is installed or what the user typed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from space_robot_msgs_py.errors import CodeError


@dataclass(frozen=True, slots=True)
class LawPolicy:
    """Which laws an experiment may name.

    Built-in laws and those of installed distributions (entry points in the group ``space_robot.laws``) it always may.

    Attributes:
        any_code: every ``module:Class`` and ``file.py:Class``: the user wrote the experiment, or vouches for it.
        typed: of those only these, because the user typed them beside the data.
        given: name of a law in the experiment to what the user typed in its place.
    """

    any_code: bool = False
    typed: frozenset[str] = frozenset()
    given: Mapping[str, str] = field(default_factory=dict)

    def law(self, name: str, said: str) -> str:
        """What is made where an experiment says ``said``.

        Args:
            name: what the law is called in the experiment; a law in standby may have a name of its own.
            said: a name of a law, ``module:Class`` or ``file.py:Class``.
        """
        return self.given.get(name, said)

    def check(self, path: str, key: str) -> None:
        """Refuse code that was not named on the command line.

        Raises:
            CodeError: with what would allow it.
        """
        if not (self.any_code or path in self.typed or path in self.given.values()):
            accepted = "--law FILE:Class, --allow-code for all it names, or replay --against plant, which needs no law"
            raise CodeError("names code, which data from elsewhere never runs", key=key, value=path, accepted=accepted)


# For an experiment that the user runs: it may name code.
TYPED = LawPolicy(any_code=True)
# For an experiment out of a log or out of the directory of a campaign, which may come from a third party.
INSTALLED = LawPolicy()
