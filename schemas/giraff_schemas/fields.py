"""What the fields of a Struct are, in the words of its source: for people who ask what a sample means."""

import ast
import copy
import sys
from pathlib import Path

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
    """By name, what the Struct itself declares, at the top level of its module."""
    found: dict[str, Field] = {}
    name = ""
    # Not by `inspect.getsource`, which reads a module several times: each service waits for this when it starts.
    module = ast.parse(Path(str(sys.modules[struct.__module__].__file__)).read_bytes())
    aliases: dict[str, ast.expr] = {}
    for class_ in module.body:
        match class_:
            case ast.Assign(targets=[ast.Name(id=alias)], value=ast.Subscript(value=ast.Name(id="tuple")) as tuple_):
                aliases[alias] = tuple_
        for statement in class_.body if isinstance(class_, ast.ClassDef) and class_.name == struct.__name__ else ():
            match statement:
                case ast.AnnAssign(target=ast.Name(id=name), annotation=annotation):
                    found[name] = Field(name, ast.unparse(_Plain(aliases).visit(annotation)), "")
                case ast.Expr(value=ast.Constant(value=str(text))) if name in found:
                    found[name] = msgspec.structs.replace(found[name], doc=" ".join(text.split()))
                case _:
                    name = ""
    return found


class _Plain(ast.NodeTransformer):
    """Shortens a type: `Annotated[float, Tuning.RAISE_ONLY]` to `float`, `tuple[float, float]` to `float[2]`.

    It does so with a tuple that has a name of its own, too.
    """

    def __init__(self, aliases: dict[str, ast.expr]) -> None:
        self._aliases = aliases

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return self.visit(copy.deepcopy(self._aliases[node.id])) if node.id in self._aliases else node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        self.generic_visit(node)
        match node:
            case ast.Subscript(value=ast.Name(id="Annotated"), slice=ast.Tuple(elts=[plain, *_])):
                return plain
            case ast.Subscript(value=ast.Name(id="tuple"), slice=ast.Tuple(elts=[first, _, *_] as parts)):
                if len({*map(ast.unparse, parts)}) == 1:
                    return ast.Subscript(first, ast.Constant(len(parts)))
        return node
