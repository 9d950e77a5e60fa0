"""What no file of the repository may hold, be called or grow to."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.rules.repository import ROOT, files, name, sources

CODE = (".py", ".c", ".h")
MAX_LINES = 400
VAGUE_NAMES = {"util", "utils", "helper", "helpers", "misc", "common"}

# Written in two parts, so that this file does not hold what it looks for.
UNFINISHED = re.compile(r"\b(TO" r"DO|FIX" r"ME|XX" r"X|NotImplemented" r"Error)\b")
BY_ROUNDING = re.compile(r"\b(LinAlg" r"Error|pi" r"nv)\b")
MACHINE_PATH = re.compile(r"(?<![\w.])/(wo" r"rk|ro" r"ot)/")
REGISTRY = re.compile(r"(py" r"pi\.org|python" r"hosted\.org|npm" r"js\.(org|com)|deb\.deb" r"ian\.org)")


@cache
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


def test_no_rounding_decides_whether_a_matrix_is_singular() -> None:
    """One processor finds regular what another one finds singular. A bound on the condition decides."""
    assert holding(BY_ROUNDING, sources(".py", under=("services", "firmware", "scripts", "bench"))) == []


@pytest.mark.parametrize("pattern", [MACHINE_PATH, REGISTRY], ids=["paths", "registries"])
def test_no_machine_and_no_registry_is_named(pattern: re.Pattern[str]) -> None:
    assert holding(pattern, list(files())) == []


def test_no_name_says_nothing() -> None:
    python = [path.relative_to(ROOT) for path in sources(".py")]
    assert [str(path) for path in python if VAGUE_NAMES & {path.stem, *path.parent.parts}] == []


def test_no_source_file_is_too_long_to_read() -> None:
    lengths = {name(path): len(text_of(path).splitlines()) for path in sources(*CODE)}
    assert {path: lines for path, lines in lengths.items() if lines > MAX_LINES} == {}


def calls_in(paths: list[Path], word: str) -> Iterator[tuple[tuple[str, int], ast.Call]]:
    """Yield the calls of the modules that hold a word, with their places. A module takes 3 ms to parse."""
    for path in paths:
        if re.search(word, source := text_of(path)):
            for node in ast.walk(ast.parse(source)):
                if isinstance(node, ast.Call):
                    yield (name(path), node.lineno), node


def test_no_text_is_read_or_written_by_the_letters_of_the_locale() -> None:
    """Ruff looks for it, too, but not where it cannot tell that something is a path."""
    paths = sources(".py", under=("schemas", "services", "firmware", "examples", "scripts"))
    calls = [
        place
        for place, call in calls_in(paths, "read_text|write_text")
        if isinstance(call.func, ast.Attribute)
        if call.func.attr in ("read_text", "write_text") and "encoding" not in {word.arg for word in call.keywords}
    ]
    assert calls == []


def test_no_door_is_opened_but_by_its_service() -> None:
    """A door watches this host's addresses, its links and its keys. `Node` does so for the service `giraff_door`."""
    calls = [
        place
        for place, call in calls_in(sources(".py", under=("services",)), "['\"]door['\"]")
        if "'door'" in map(ast.unparse, (*call.args, *(word.value for word in call.keywords)))
        if ast.unparse(call.func).endswith("session") or "role" in {word.arg for word in call.keywords}
    ]
    assert calls == []


LOOPHOLES = {"skip", "skipif", "skipIf", "skipUnless", "xfail", "importorskip", "SkipTest"}


LIBRARIES = ("msgspec", "tomllib", "yaml", "csv")
"""Those that say in their own words what they cannot read."""
SAID = {"UnicodeDecodeError", "RecursionError"} | {f"{library}." for library in LIBRARIES}
CAUGHT = re.compile(rf"\bexcept\b[^:]*({'|'.join(map(re.escape, SAID))}|ValueError)")


def raw_texts(source: str) -> list[int]:
    """Lines that pass on what a library says of a text, and not through `plain`."""
    found: list[int] = []
    tree = ast.parse(source if CAUGHT.search(source) else "")
    for tried in (node for node in ast.walk(tree) if isinstance(node, ast.Try)):
        calls = {ast.unparse(call.func) for line in tried.body for call in ast.walk(line) if isinstance(call, ast.Call)}
        reads = any(
            call in ("int", "float") or (call.startswith(LIBRARIES) and "." in call and ".structs." not in call)
            for call in calls
        )
        for handler in tried.handlers:
            caught = ast.unparse(handler.type) if handler.type else ""
            if not handler.name or not (any(each in caught for each in SAID) or (reads and "ValueError" in caught)):
                continue
            inner = [node for line in handler.body for node in ast.walk(line)]
            passed = [
                node
                for call in inner
                if isinstance(call, ast.Call)
                for node in call.args
                if "plain" in ast.unparse(call.func)
            ]
            passed += [raised.cause for raised in inner if isinstance(raised, ast.Raise) and raised.cause]
            passed += [node.value for node in inner if isinstance(node, ast.Attribute)]
            found += [
                node.lineno
                for node in inner
                if isinstance(node, ast.Name) and node.id == handler.name and node not in passed
            ]
    return found


def test_what_a_library_says_is_told_in_our_words() -> None:
    shown = {name(path): raw_texts(text_of(path)) for path in sources(".py", under=("schemas", "services", "scripts"))}
    assert {path: lines for path, lines in shown.items() if lines} == {}


def test_a_raw_text_shows() -> None:
    for caught in ("msgspec.ValidationError", "(OSError, tomllib.TOMLDecodeError)", "UnicodeDecodeError"):
        assert raw_texts(f"try:\n    read()\nexcept {caught} as error:\n    raise E(f'a: {{error}}') from error") == [4]
    assert raw_texts("try:\n    msgspec.convert(a, B)\nexcept ValueError as error:\n    tell(str(error))") == [4]
    assert (
        raw_texts("try:\n    msgspec.convert(a, B)\nexcept ValueError as error:\n    raise E(plain(error)) from error")
        == []
    )


def loopholes(source: str) -> list[str]:
    """The names in a test module by which a test can end without having passed or failed."""
    found: list[str] = []
    for node in ast.walk(ast.parse(source if any(word in source for word in LOOPHOLES) else "")):
        match node:
            case ast.Attribute(attr=word) | ast.Name(id=word) | ast.alias(name=word) if word in LOOPHOLES:
                found.append(word)
    return found


def test_every_test_passes_or_fails() -> None:
    found = {name(path): loopholes(text_of(path)) for path in sources(".py", under=("tests",))}
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
    assert BY_ROUNDING.search("except np.linalg.LinAlg" + "Error:")
    assert BY_ROUNDING.search("np.linalg.pi" + "nv(normal)")
    assert REGISTRY.search("--index-url https://py" + "pi.org/simple")
