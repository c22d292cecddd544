"""Types of fields whose models are only imported when a file has something there."""

from __future__ import annotations

from functools import cached_property
from importlib import import_module
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, TypeAdapter
from pydantic_core import CoreSchema, core_schema


class Later:
    """Beside ``Any`` in ``Annotated``: what is there has to fit a type of another module.

    Values, complaints and JSON schema are those of the type itself. Many files say nothing of faults, of which there
    are forty models: to import and build them takes a fifth of a ``check``.

    Args:
        path: ``module:Name`` of a model, or of a type that is made of models.
    """

    def __init__(self, path: str) -> None:
        self._module, _, self._name = path.partition(":")

    @cached_property
    def type(self) -> Any:
        """The type, imported."""
        return getattr(import_module(self._module), self._name)

    @cached_property
    def _adapter(self) -> TypeAdapter[Any]:
        return TypeAdapter(self.type)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """What the model around it does with a value: pydantic puts the place before the complaints of the type."""
        return core_schema.no_info_plain_validator_function(lambda value: self._adapter.validate_python(value))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """The schema of the type."""
        # Wrapped, as pydantic puts among the definitions only what is inside of what a handler gets.
        return handler(core_schema.definitions_schema(self._adapter.core_schema, []))
