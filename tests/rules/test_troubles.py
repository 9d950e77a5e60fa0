"""No program takes apart what another one says: it compares a trouble, or reads its action."""

import ast
import re
from collections.abc import Iterator
from typing import Final

import pytest

from tests.rules.repository import SOURCE_ROOTS, name, sources

SAYS: Final = {"remedy", "reason", "trouble", "refusal", "why"}
"""Names of what somebody says is wrong."""
TAKES_APART: Final = {
    *("replace", "split", "rsplit", "partition", "rpartition", "startswith", "endswith", "find", "index"),
    *("removeprefix", "removesuffix", "search", "match", "fullmatch", "findall", "finditer"),
}
_WORD, _METHOD = f"({'|'.join(SAYS)}|what)", f"({'|'.join(TAKES_APART)})"
MAY_BE: Final = re.compile(rf"\b{_WORD}\b.*(\.{_METHOD}\(| [=!]= )|(\.{_METHOD}\(| in | [=!]= ).*\b{_WORD}\b")
"""A file without such a line needs no syntax tree."""
_OF_A_PAGE: Final = "(replace|replaceAll|match|matchAll|includes|startsWith|endsWith|indexOf|search|split)"
IN_A_PAGE: Final = re.compile(rf"\b{_WORD}\.{_OF_A_PAGE}\(|\.{_OF_A_PAGE}\([\w.?]*\b{_WORD}\)")


def is_said(node: ast.AST) -> bool:
    """Return True if the expression holds what somebody says."""
    names = [getattr(each, "attr", None) or getattr(each, "id", None) for each in ast.walk(node)]
    return not SAYS.isdisjoint(names) or (isinstance(node, ast.Attribute) and node.attr == "what")


def taken_apart(source: str) -> Iterator[str]:
    """Yield the line and the code of each search in a sentence, and of each comparison with a known one."""
    for node in ast.walk(ast.parse(source if MAY_BE.search(source) else "")):
        match node:
            case ast.Call(func=ast.Attribute(value=whole, attr=method), args=args) if method in TAKES_APART:
                found = "structs" not in ast.unparse(whole) and any(map(is_said, (whole, *args)))
            case ast.Compare(ops=[ast.In() | ast.NotIn()], comparators=[whole]):
                found = isinstance(whole, ast.Name | ast.Attribute | ast.Call) and is_said(whole)
            case ast.Compare(left=one, ops=[ast.Eq() | ast.NotEq()], comparators=[other]):
                texts = [each for each in (one, other) if getattr(each, "attr", "") in {"what", "remedy"}]
                found = bool(texts) and not isinstance(one, ast.Name) and not isinstance(other, ast.Name)
            case _:
                continue
        if found:
            yield f"{node.lineno}: {ast.unparse(node)}"


def test_no_program_takes_a_sentence_apart() -> None:
    found = list[str]()
    for path in sources(".py", under=SOURCE_ROOTS):
        found += [f"{name(path)}:{each}" for each in taken_apart(path.read_text())]
    for path in sources(".js", under=SOURCE_ROOTS):
        found += [f"{name(path)}: {each.group()}" for each in IN_A_PAGE.finditer(path.read_text())]
    assert found == []


@pytest.mark.parametrize(
    "line",
    [
        'str(lease.reason).startswith("idle")',
        'why.replace("a", "b")',
        '"hold" in trouble.remedy',
        '"x" not in str(state.reason)',
        're.search("x", why)',
        "state.reason.what == IDLE.what",
        'reason.what == "idle"',
        '"idle" != reason.what',
    ],
)
def test_each_way_to_take_one_apart_is_found(line: str) -> None:
    assert len(list(taken_apart(line))) == 1


def test_a_comparison_of_troubles_and_an_action_take_nothing_apart() -> None:
    fine = (
        "state.reason == IDLE",
        'reason.action == "release"',
        'msgspec.structs.replace(reason, action="")',
        "trouble in told",
    )
    assert [each for line in fine for each in taken_apart(line)] == []
    assert IN_A_PAGE.search("const text = why.replace(HELD, '')")
    assert IN_A_PAGE.search("if (said.includes(verdict?.reason)) continue;")
