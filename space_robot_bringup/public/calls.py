"""Errors about options of the command line, said about arguments of a call; and extras that are missing."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import ParamSpec, TypeVar

from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_msgs_py.extras import install

Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")

OPTION = re.compile(r"--([a-z]+(?:-[a-z]+)*)")
# Options that are arguments of another name; every other one is called the same.
ARGUMENTS = {"set": "overrides", "figure": "figures"}


def for_python(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """A function whose errors name its arguments, where the library below names the options of the command line."""

    @wraps(function)
    def call(*args: Parameters.args, **kwargs: Parameters.kwargs) -> Result:
        try:
            return function(*args, **kwargs)
        except SpaceRobotError as error:
            raise in_python(error).with_traceback(error.__traceback__) from None

    return call


def in_python(error: SpaceRobotError) -> SpaceRobotError:
    """The same error with ``--some-option`` as ``some_option``."""
    message, key, accepted = (OPTION.sub(_argument, text) for text in (error.message, error.key, error.accepted))
    made = type(error)(message, key=key, value=error.value, accepted=accepted)
    made.problems = tuple(map(in_python, error.problems))
    return made


@contextmanager
def needing(what: str, extra: str) -> Iterator[None]:
    """Imports of optional packages; a missing one is an error that names the extra that brings it.

    Args:
        what: is to be done with them.
        extra: of this project's installation.

    Raises:
        SpecError: one is missing.
    """
    try:
        yield
    except ImportError as error:
        raise SpecError(f"{what} needs more packages ({error})", accepted=install(extra)) from None


def _argument(option: re.Match[str]) -> str:
    return ARGUMENTS.get(option[1], option[1].replace("-", "_"))
