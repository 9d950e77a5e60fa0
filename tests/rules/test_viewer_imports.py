"""The viewer is imported inside the functions that draw, so that nothing else pays for it or needs it."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import pytest

from tests.rules.repository import SOURCE_ROOTS, name, sources


def imports_at_module_level(node: ast.AST) -> Iterator[str]:
    """Names of the modules that importing this code would import."""
    for child in ast.iter_child_nodes(node):
        match child:
            case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.Lambda():
                continue
            case ast.If(test=ast.Name(id="TYPE_CHECKING")):
                continue
            case ast.Import(names=names):
                yield from (alias.name for alias in names)
            case ast.ImportFrom(module=str(module)):
                yield module
        yield from imports_at_module_level(child)


def imports_viewer(source: str) -> bool:
    imported = imports_at_module_level(ast.parse(source))
    return any(module.partition(".")[0] == "rerun" for module in imported)


def test_no_module_imports_the_viewer() -> None:
    modules = sources(".py", under=SOURCE_ROOTS)
    assert [name(path) for path in modules if imports_viewer(path.read_text())] == []


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("import rerun as rr", True),
        ("from rerun.blueprint import Blueprint", True),
        ("try:\n    import rerun\nexcept ImportError:\n    pass", True),
        ("class Viewer:\n    import rerun", True),
        ("def draw() -> None:\n    import rerun", False),
        ("if TYPE_CHECKING:\n    import rerun", False),
        ("import rerunner", False),
    ],
)
def test_the_check_tells_module_level_from_inside_a_function(source: str, expected: bool) -> None:
    assert imports_viewer(source) is expected
