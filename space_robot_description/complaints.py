"""What pydantic complains of, in the words of this project: what would be accepted in place of a value."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

# By the kind of the complaint; names in braces are what pydantic says of it.
WORDS = {
    "literal_error": "{expected}",
    "enum": "{expected}",
    "greater_than": "a number greater than {gt}",
    "greater_than_equal": "a number greater than or equal to {ge}",
    "less_than": "a number less than {lt}",
    "less_than_equal": "a number less than or equal to {le}",
    "multiple_of": "a multiple of {multiple_of}",
    "finite_number": "a finite number",
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_parsing_size": "a whole number of a usual size",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "string_type": "text",
    "string_too_long": "text of at most {max_length} characters",
    "string_too_short": "text of at least {min_length} characters",
    "none_required": "null",
    "list_type": "a list",
    "tuple_type": "a list",
    "set_type": "a list",
    "iterable_type": "a list",
    "dict_type": "a section with keys",
    "mapping_type": "a section with keys",
    "model_type": "a section with keys",
    "model_attributes_type": "a section with keys",
    "dataclass_type": "a section with keys",
    "too_short": "at least {min_length} values, not {actual_length}",
    "too_long": "at most {max_length} values, not {actual_length}",
    "union_tag_not_found": "a section with {discriminator}",
    "union_tag_invalid": "{discriminator}: {expected_tags}",
}
# What our own checks raise comes with this in front.
OWN = "Value error, "


def accepted_by(problem: Mapping[str, Any]) -> str:
    """What would be accepted, from one of the errors that pydantic lists."""
    words = WORDS.get(str(problem["type"]))
    if words is None:
        return str(problem["msg"]).removeprefix(OWN)
    known = {name: _number(value) for name, value in problem.get("ctx", {}).items()}
    known["discriminator"] = known.get("discriminator", "kind").strip("'")
    return words.format_map(known)


def _number(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
