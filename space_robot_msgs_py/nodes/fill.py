"""Fields of message objects with values of their types: the one place where they are set."""

from __future__ import annotations

from typing import Any, TypeVar

Message = TypeVar("Message")


def fill(message: Message, /, **fields: Any) -> Message:
    """Set fields of a message object, each cast to what its definition says; returns the message.

    rclpy does not check: an int in a float field is sent as 5e-324, a numpy.bool of True as False.

    Args:
        message: of any type, also a request or response.
        fields: value by name; of a sequence every item is cast.

    Raises:
        AttributeError: there is no such field.
        ValueError, TypeError: the value cannot be cast.
    """
    types: dict[str, str] = message.get_fields_and_field_types()  # type: ignore[attr-defined]
    for name, value in fields.items():
        if name not in types:
            raise AttributeError(f"{type(message).__name__} has no field {name}")
        kind = types[name]
        is_many = kind.startswith("sequence<") or kind.endswith("]")
        cast = _cast_of(kind.removeprefix("sequence<"))
        setattr(message, name, [cast(item) for item in value] if is_many else cast(value))
    return message


def _cast_of(kind: str) -> Any:
    # Without a bound on its length.
    kind = kind.partition("[")[0].partition("<")[0].partition(",")[0].rstrip(">")
    if kind == "boolean":
        return bool
    if kind in ("float", "double"):
        return float
    if kind.startswith(("int", "uint")):
        return int
    if kind in ("string", "wstring"):
        return str
    # Bytes, and other messages: what they are is seen where they are made.
    return lambda value: value
