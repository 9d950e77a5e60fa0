"""Tests by their node ids, looked up without running or importing anything."""

import ast
import re
from functools import cache

from tests.rules.repository import ROOT

ELSEWHERE = ("campaign", "functional", "hosts", "mutants", "timing")
"""Folders of tests that are none of the simulated part of `make test`."""


def exists(test: str) -> bool:
    """Return whether there is such a file, with such a test or class of tests if one is named.

    `[..]`, the row of a table, is not looked at.
    """
    file, _, function = test.partition("::")
    if not re.fullmatch(r"tests/(\w+/)+test_\w+\.py", file) or not (ROOT / file).is_file():
        return False
    tests = _functions(file)
    return (function.partition("[")[0] in tests) if function else bool(tests)


def is_simulated(test: str) -> bool:
    """Whether the simulated part of `make test` runs it."""
    return exists(test) and test.split("/")[1] not in ELSEWHERE


@cache
def _functions(file: str) -> frozenset[str]:
    body = ast.parse((ROOT / file).read_text()).body
    named = [each.name for each in body if isinstance(each, ast.FunctionDef | ast.ClassDef)]
    return frozenset(name for name in named if name.startswith(("test_", "Test")))
