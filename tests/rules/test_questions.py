"""A question to several is asked so that each answer comes.

Answers have the question's key, and by default Zenoh keeps the last answer of a key. Two processes of one service
answer to one key, too: in the product each question is asked so, whatever its key.
"""

import ast
import re

import pytest

from giraff_schemas import topics
from tests.rules.repository import name, sources

PRODUCT = ("schemas", "services", "firmware", "scripts", "bench", "examples")
OF_ALL = {"health_key": 2, "frame_key": 2}
"""Functions that make a key of several, unless they are given so many arguments."""


def is_of_several(key: ast.expr) -> bool:
    """Return True if the source shows that this key has a wildcard. A variable does not show it."""
    match key:
        case ast.Call(func=ast.Attribute(attr="at")):
            return False
        case ast.Call(func=ast.Name(id=made), args=args, keywords=words) if made in OF_ALL:
            if len(args) + len(words) < OF_ALL[made]:
                return True
        case ast.Constant(value=str(text)):
            return "*" in text
        case ast.Name(id=row):
            return "*" in getattr(getattr(topics, row, None), "key", "")
    return any(is_of_several(part) for part in ast.iter_child_nodes(key) if isinstance(part, ast.expr))


def lossy(source: str, *, is_product: bool) -> list[int]:
    """Return the lines of a module that ask on a session, and may miss answers."""
    found = []
    for node in ast.walk(ast.parse(source)) if ".get(" in source and re.search("(?i)session|timeout", source) else ():
        match node:
            case ast.Call(func=ast.Attribute(attr="get", value=asked), args=[key, *_], keywords=words):
                given = {word.arg: ast.unparse(word.value) for word in words}
                asks = ast.unparse(asked).lower().endswith("session") or "timeout" in given
                each = given.get("consolidation", "").endswith("ConsolidationMode.NONE")
                if asks and not each and "liveliness" not in ast.unparse(asked) and (is_product or is_of_several(key)):
                    found.append(node.lineno)
    return found


def test_each_answer_is_heard() -> None:
    found = {
        name(path): lossy(path.read_text(), is_product=under != "tests")
        for under in (*PRODUCT, "tests")
        for path in sources(".py", under=(under,))
    }
    assert {path: lines for path, lines in found.items() if lines} == {}, "see giraff_node/network/replies.py"


@pytest.mark.parametrize(
    ("source", "in_product", "in_tests"),
    [
        ("session.get(health_key(robot), f, timeout=2.0)", True, True),
        ("self._session.get(key, f)", True, False),
        ("peer.get(health_key(robot, 'base'), timeout=2.0)", True, False),
        ("connection.session.get(key_of(robot, PARAM_DESCRIBE), f)", True, True),
        ("session.get(key_of(robot, PARAM_DESCRIBE.at('base')), f)", True, False),
        ("session.get(f'@/{process}/*', f, consolidation=zenoh.ConsolidationMode.LATEST)", True, True),
        ("session.get(\n    frame_key('otto'), f, consolidation=zenoh.ConsolidationMode.NONE\n)", False, False),
        ("session.liveliness().get(alive_key(robot), timeout=1.0)", False, False),
        ("answers.get(timeout=1.0)", False, False),
        ("settings.get('*')", False, False),
    ],
)
def test_a_question_that_may_miss_answers_shows(source: str, *, in_product: bool, in_tests: bool) -> None:
    assert lossy(source, is_product=True) == [1] * in_product
    assert lossy(source, is_product=False) == [1] * in_tests
