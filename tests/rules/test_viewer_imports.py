"""Only giraff_viewer imports rerun, and that is imported only where somebody has asked to see: nobody else needs it."""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.rules.repository import SOURCE_ROOTS, name, sources
from tests.support.tools import finished


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
    if not re.search(r"rerun|giraff_viewer", source):
        return False
    imported = imports_at_module_level(ast.parse(source))
    return any(module.partition(".")[0] in {"rerun", "rerun_cli", "giraff_viewer"} for module in imported)


def may_draw(path: Path) -> bool:
    """The viewer's own package, and what `giraff view` and `giraff camera view` import on demand."""
    if path.parent.parent.name == "giraff_cli":
        return (path.parent.name == "view" and path.name != "commands.py") or path.parts[-2:] == ("camera", "window.py")
    return path.parent.name == "giraff_viewer"


def test_no_other_module_imports_the_viewer() -> None:
    modules = [path for path in sources(".py", under=SOURCE_ROOTS) if not may_draw(path)]
    assert [name(path) for path in modules if imports_viewer(path.read_text())] == []


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("import rerun as rr", True),
        ("from rerun.blueprint import Blueprint", True),
        ("from giraff_viewer.show import Show", True),
        ("try:\n    import rerun\nexcept ImportError:\n    pass", True),
        ("class Viewer:\n    import rerun", True),
        ("def draw() -> None:\n    import rerun", False),
        ("if TYPE_CHECKING:\n    import rerun", False),
        ("import rerunner", False),
    ],
)
def test_the_check_tells_module_level_from_inside_a_function(source: str, expected: bool) -> None:
    assert imports_viewer(source) is expected


def test_the_command_line_starts_without_the_viewer() -> None:
    script = "import sys, giraff_cli.main; sys.exit('rerun' in sys.modules)"
    assert finished([sys.executable, "-c", script]).returncode == 0
