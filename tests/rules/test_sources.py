"""What no file of the repository may hold, be called or grow to."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from tests.rules.repository import ROOT, files, name, sources

CODE = (".py", ".c", ".h")
MAX_LINES = 400
VAGUE_NAMES = {"util", "utils", "helper", "helpers", "misc", "common"}

# Written in two parts, so that this file does not hold what it looks for.
UNFINISHED = re.compile(r"\b(TO" r"DO|FIX" r"ME|XX" r"X|NotImplemented" r"Error)\b")
MACHINE_PATH = re.compile(r"(?<![\w.])/(wo" r"rk|ro" r"ot)/")
REGISTRY = re.compile(r"(py" r"pi\.org|python" r"hosted\.org|npm" r"js\.(org|com)|deb\.deb" r"ian\.org)")


def text_of(path: Path) -> str:
    """A file's text; empty for one that is not text."""
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return ""


def holding(pattern: re.Pattern[str], paths: list[Path]) -> list[str]:
    return [
        f"{name(path)}:{number}: {line.strip()}"
        for path in paths
        for number, line in enumerate(text_of(path).splitlines(), start=1)
        if pattern.search(line)
    ]


def test_nothing_is_left_unfinished() -> None:
    assert holding(UNFINISHED, sources(*CODE, ".toml", ".yml", ".sh", "")) == []


@pytest.mark.parametrize("pattern", [MACHINE_PATH, REGISTRY], ids=["paths", "registries"])
def test_no_machine_and_no_registry_is_named(pattern: re.Pattern[str]) -> None:
    assert holding(pattern, list(files())) == []


def test_no_name_says_nothing() -> None:
    python = [path.relative_to(ROOT) for path in sources(".py")]
    assert [str(path) for path in python if VAGUE_NAMES & {path.stem, *path.parent.parts}] == []


def test_no_source_file_is_too_long_to_read() -> None:
    lengths = {name(path): len(path.read_text().splitlines()) for path in sources(*CODE)}
    assert {path: lines for path, lines in lengths.items() if lines > MAX_LINES} == {}


def test_no_text_is_read_or_written_by_the_letters_of_the_locale() -> None:
    """Ruff looks for it, too, but not where it cannot tell that something is a path."""
    calls = [
        (name(path), call.lineno)
        for path in sources(".py", under=("schemas", "services", "firmware", "examples", "scripts"))
        for call in ast.walk(ast.parse(path.read_bytes()))
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute)
        if call.func.attr in ("read_text", "write_text") and "encoding" not in {word.arg for word in call.keywords}
    ]
    assert calls == []


LOOPHOLES = {"skip", "skipif", "skipIf", "skipUnless", "xfail", "importorskip", "SkipTest"}


def loopholes(source: str) -> list[str]:
    """The names in a test module by which a test can end without having passed or failed."""
    found: list[str] = []
    if not any(word in source for word in LOOPHOLES):  # most modules, and a module takes 3 ms to parse
        return found
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Attribute(attr=word) | ast.Name(id=word) | ast.alias(name=word) if word in LOOPHOLES:
                found.append(word)
    return found


def test_every_test_passes_or_fails() -> None:
    found = {name(path): loopholes(path.read_text()) for path in sources(".py", under=("tests",))}
    assert {path: words for path, words in found.items() if words} == {}


@pytest.mark.parametrize(
    "source",
    [
        "pytest.skip('no compiler')",
        "@pytest.mark.xfail\ndef test() -> None: ...",
        "numpy = pytest.importorskip('numpy')",
        "from unittest import SkipTest",
    ],
)
def test_a_loophole_shows(source: str) -> None:
    assert loopholes(source)


def test_what_no_file_may_hold_shows() -> None:
    assert UNFINISHED.search("# TO" + "DO: later")
    assert MACHINE_PATH.search('open("/wo' + 'rk/main")')
    assert not MACHINE_PATH.search("https://example.org/wo" + "rk/plan")
    assert REGISTRY.search("--index-url https://py" + "pi.org/simple")
