"""What the fields of a Struct are, in the words of its source: for people who ask what a sample means."""

from __future__ import annotations

import ast
import inspect
import textwrap

import msgspec


class Field(msgspec.Struct, frozen=True):
    """One field."""

    name: str
    type: str
    doc: str
    """With its unit; empty: its name says it all."""


def fields_of(struct: type[msgspec.Struct]) -> tuple[Field, ...]:
    """In the order in which it declares them, those that it inherits first."""
    found: dict[str, Field] = {}
    for base in reversed(struct.__mro__):
        if issubclass(base, msgspec.Struct) and base is not msgspec.Struct:
            found |= _declared(base)
    return tuple(field for name, field in found.items() if name in struct.__struct_fields__)


def _declared(struct: type[msgspec.Struct]) -> dict[str, Field]:
    """By name, what the Struct itself declares."""
    found: dict[str, Field] = {}
    name = ""
    for class_ in ast.parse(textwrap.dedent(inspect.getsource(struct))).body:
        for statement in class_.body if isinstance(class_, ast.ClassDef) else ():
            match statement:
                case ast.AnnAssign(target=ast.Name(id=name), annotation=annotation):
                    found[name] = Field(name, ast.unparse(_plain(annotation)), "")
                case ast.Expr(value=ast.Constant(value=str(text))) if name in found:
                    found[name] = msgspec.structs.replace(found[name], doc=" ".join(text.split()))
                case _:
                    name = ""
    return found


def _plain(annotation: ast.expr) -> ast.expr:
    """The type alone: of `Annotated[float, Tuning.RAISE_ONLY]` the first."""
    match annotation:
        case ast.Subscript(value=ast.Name(id="Annotated"), slice=ast.Tuple(elts=[plain, *_])):
            return plain
    return annotation
