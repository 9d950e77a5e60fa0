"""The topics table is complete, and the only place where a key is written."""

import ast
import re
from collections.abc import Iterator

import pytest

from giraff_schemas import messages, topics
from tests.rules.repository import ROOT, SOURCE_ROOTS, name, sources

TABLE = ROOT / "schemas" / "giraff_schemas" / "topics.py"
NAMES_OF_ROS = ROOT / "services" / "giraff_ros2" / "topics.py"


def subclasses(sample: type[messages.Sample]) -> Iterator[type[messages.Sample]]:
    for subclass in sample.__subclasses__():
        yield subclass
        yield from subclasses(subclass)


def test_every_sample_is_carried_by_a_topic() -> None:
    declared = {sample for sample in subclasses(messages.Sample) if sample.__module__.startswith("giraff_schemas.")}
    assert declared
    assert declared == {topic.schema for topic in topics.TOPICS}


def test_every_topic_is_in_the_table_once() -> None:
    named = [value for value in vars(topics).values() if isinstance(value, topics.Topic)]
    assert sorted(topic.key for topic in topics.TOPICS) == sorted(topic.key for topic in named)
    keys = [topic.key for topic in topics.TOPICS]
    assert len(keys) == len(set(keys))


HEADS = (
    [key.split("/")[2] for key in (topics.alive_key("robot"), topics.health_key("robot"), topics.frame_key("robot"))]
    + [topics.PARAM_DESCRIBE.key.removesuffix("/*")]
    + [topic.key.removesuffix("/*") for topic in topics.TOPICS if topic.key.endswith("/*")]
)
KEY = re.compile(
    # Below a key with one row for each operator or sensor, or below the root.
    rf"({topics.ROOT}|{'|'.join(HEADS)})/.*"
    # A name that can be nothing but a key.
    rf"|{'|'.join(topic.key for topic in topics.TOPICS if '_' in topic.key)}"
)
IN_KEYS = [f"{head}/" for head in (topics.ROOT, *HEADS)] + [topic.key for topic in topics.TOPICS if "_" in topic.key]
"""A module without one of these, and without a declaration, writes no key."""
DECLARATIONS = {
    "declare_publisher",
    "declare_subscriber",
    "declare_queryable",
    "declare_querier",
    "declare_token",
}


def strings(tree: ast.AST) -> Iterator[str]:
    """The string literals of a module as written, `*` for each value put into one."""
    match tree:
        case ast.Constant(value=str(text)):
            yield text
        case ast.JoinedStr(values=parts):
            yield "".join(str(part.value) if isinstance(part, ast.Constant) else "*" for part in parts)
        case _:
            for child in ast.iter_child_nodes(tree):
                yield from strings(child)


def written_keys(source: str) -> list[str]:
    """The string literals of a module that are keys, or that a declaration on a session takes for one."""
    tree = ast.parse(source if any(word in source for word in (*IN_KEYS, *DECLARATIONS)) else "")
    declared = [
        first
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in DECLARATIONS
        for first in node.args[:1]
        if isinstance(first, ast.Constant | ast.JoinedStr)
    ]
    keys = {text for text in strings(tree) if KEY.fullmatch(text)}
    return sorted(keys.union(*map(strings, declared)))


def test_no_key_is_written_outside_the_table() -> None:
    modules = [path for path in sources(".py", under=SOURCE_ROOTS) if path not in (TABLE, NAMES_OF_ROS)]
    written = {name(path): written_keys(path.read_text()) for path in modules}
    assert {path: keys for path, keys in written.items() if keys} == {}


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("session.put('giraff/robot/tick', b'')", ["giraff/robot/tick"]),
        ("topic = f'cmd_vel/{operator}'", ["cmd_vel/*"]),
        ("key = f'range/{sensor}'", ["range/*"]),
        ("key = 'cmd_vel'", ["cmd_vel"]),
        ("session.declare_subscriber('wheels', print)", ["wheels"]),
        ("session.declare_subscriber(key_of(robot, WHEELS), print)", []),
        ("settings.get('range')", []),
        ("table = 'base'", []),
    ],
)
def test_the_check_knows_a_key_when_it_sees_one(source: str, expected: list[str]) -> None:
    assert written_keys(source) == expected
