"""The messages' JSON Schemas, in the plain form that Foxglove takes.

Its parser wants a `type` at each field: it knows neither `$ref` nor `anyOf`, an `enum` only beside a type, and an array
by one type of its items, which is no array. So what is referred to stands where it is used, and a field that may be
null has the type that it has when it is not. A field that is an array of arrays is left out of the schema: with it,
Foxglove would refuse the whole key. The data have it all the same.
"""

from __future__ import annotations

from typing import Any, Final

import msgspec

ENCODING: Final = "jsonschema"


def name_of(type_: type[msgspec.Struct]) -> str:
    """As in the encoding that travels with each sample."""
    return f"giraff.{type_.__name__}"


def schema_of(type_: type[msgspec.Struct]) -> bytes:
    """Return the JSON Schema of a message."""
    _, components = msgspec.json.schema_components([type_])
    return msgspec.json.encode(_plain(components[type_.__name__], components))


def _plain(schema: dict[str, Any], components: dict[str, Any]) -> dict[str, Any]:
    if "$ref" in schema:
        return _plain(components[schema["$ref"].rpartition("/")[2]], components)
    if "anyOf" in schema:
        (only,) = (choice for choice in schema["anyOf"] if choice != {"type": "null"})
        return _plain(only, components)
    plain = {name: value for name, value in schema.items() if name not in {"prefixItems", "items", "required"}}
    if "enum" in schema:
        return {"type": "string", **plain}
    if "prefixItems" in schema or schema.get("type") == "array":
        return {**plain, "items": _plain((schema.get("prefixItems") or [schema["items"]])[0], components)}
    if schema.get("type") == "object":
        fields = {name: _plain(field, components) for name, field in schema.get("properties", {}).items()}
        flat = {k: field for k, field in fields.items() if field.get("items", {}).get("type") != "array"}
        return {**plain, "properties": flat}
    return plain
