"""A recording's format number changes with the samples: no reader takes those of another format for its own."""

import hashlib
from collections.abc import Iterator, Sequence
from types import GenericAlias
from typing import Any, Literal, get_args, get_origin, get_type_hints

import msgspec

from giraff_schemas.format import DIGEST, FORMAT
from giraff_schemas.params import ParamAnswer
from giraff_schemas.topics import PARAM_DESCRIBE, TOPICS


def text_of(type_: Any) -> str:
    """The type of a field: the same text by every version of Python."""
    parts = get_args(type_)
    if get_origin(type_) is Literal:
        return f"Literal{sorted(map(repr, parts))}"
    if not parts:
        return "None" if type_ is type(None) else str(getattr(type_, "__name__", type_))
    kind, texts = get_origin(type_), [text_of(part) for part in parts]
    return f"{kind.__name__}[{', '.join(texts)}]" if kind in {tuple, list, dict} else " | ".join(sorted(texts))


def structs_in(type_: Any) -> Iterator[type[msgspec.Struct]]:
    """The Structs that a type is, or that stand within it."""
    if isinstance(type_, type) and issubclass(type_, msgspec.Struct):
        yield type_
    for part in get_args(type_):
        yield from structs_in(part)


def digest(rows: Sequence[tuple[str, type[msgspec.Struct]]]) -> str:
    """Return the digest of these keys and Structs, and of all Structs that stand in their fields."""
    lines = {f"{key}: {struct.__name__}" for key, struct in rows}
    waiting, seen = [struct for _, struct in rows], set[type[msgspec.Struct]]()
    while waiting:
        struct = waiting.pop()
        hints, form = get_type_hints(struct), struct.__struct_config__
        lines.add(f"{struct.__name__} {form.tag_field} {form.tag} {form.array_like}")
        for field in msgspec.structs.fields(struct):
            lines.add(f"{struct.__name__}.{field.encode_name}: {text_of(hints[field.name])}")
            waiting += set(structs_in(hints[field.name])) - seen
        seen.add(struct)
    return hashlib.sha256("\n".join(sorted(lines)).encode()).hexdigest()[:16]


def test_the_number_is_that_of_these_fields() -> None:
    found = digest([*((topic.key, topic.schema) for topic in TOPICS), (PARAM_DESCRIBE.key, ParamAnswer)])
    assert found == DIGEST, (
        "a key, or the name or type of a field, has changed, and recordings with it: "
        f"in schemas/giraff_schemas/format.py raise FORMAT to {FORMAT + 1} and write this digest: {found!r}"
    )


def test_a_change_of_a_name_or_a_type_shows_however_deep() -> None:
    def of(*, name: str = "x", type_: Any = float, key: str = "key") -> str:
        inner = msgspec.defstruct("Inner", [(name, type_)])
        return digest([(key, msgspec.defstruct("Outer", [("inner", GenericAlias(tuple, (inner, ...)) | None)]))])

    changed = [of(), of(name="y"), of(type_=int), of(type_=float | None), of(key="other"), of(type_=Literal["a"])]
    assert len({*changed, of(type_=Literal["a", "b"])}) == len(changed) + 1
    assert of() == of()
