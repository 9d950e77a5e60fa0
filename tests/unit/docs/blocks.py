"""The commands in the fenced blocks of README and docs, as a shell would take them apart."""

import re
import shlex
from collections.abc import Iterator
from typing import Final, NamedTuple

from tests.rules.repository import ROOT

PAGES: Final = tuple(
    str(page.relative_to(ROOT))
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), ROOT / "firmware" / "README.md")
)
_BLOCK: Final = re.compile(r"^( *)```(\w*)\n(.*?)^\1```$", re.MULTILINE | re.DOTALL)
_ASSIGNMENT: Final = re.compile(r"[A-Z][A-Z_0-9]*=")
_COMMAND: Final = re.compile(r"(\$ |giraff [a-z0-9]+ (?!·)|make |sudo |docker|\.venv/|python )")


class Block(NamedTuple):
    """A fenced block of a page."""

    page: str
    line: int
    language: str
    text: str


class Command(NamedTuple):
    """One program with its words; what stands before it in the same line is in `variables`."""

    place: str
    variables: dict[str, str]
    words: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.place}: {shlex.join(self.words)}"


def blocks(page: str) -> Iterator[Block]:
    """Yield the fenced blocks of a page."""
    text = (ROOT / page).read_text()
    for found in _BLOCK.finditer(text):
        indent, language, body = found.groups()
        lines = "".join(line.removeprefix(indent) for line in body.splitlines(keepends=True))
        yield Block(page, text.count("\n", 0, found.start()) + 2, language, lines)


def hidden(page: str) -> list[str]:
    """Return the commands in blocks of no language, where no test would see them."""
    return [
        f"{page}:{block.line}: {line}"
        for block in blocks(page)
        if not block.language
        for line in block.text.splitlines()
        if _COMMAND.match(line)
    ]


def commands(page: str) -> list[Command]:
    """Return all commands of a page; those of a pipe or of a list by themselves."""
    return [each for block in blocks(page) for place, line in _lines(block) for each in split(place, line)]


def mentioned(page: str) -> list[Command]:
    """Return what a page names in its text, between backquotes, of `giraff` and `make`."""
    text = _BLOCK.sub("", (ROOT / page).read_text())
    found = re.findall(r"`((?:giraff|make) [^`]+)`", text)
    return [next(split(page, " ".join(said.split()).replace("\\|", "|"))) for said in found]


def _lines(block: Block) -> Iterator[tuple[str, str]]:
    """Yield the command lines; in a `console` block they begin with a dollar, and the rest is output."""
    if block.language not in {"sh", "console"}:
        return
    text = re.sub(r"\\\n", "  ", block.text)
    for line in text.splitlines():
        if block.language == "sh":
            yield f"{block.page}:{block.line}", line
        elif line.startswith("$ "):
            yield f"{block.page}:{block.line}", line[2:]


def split(place: str, line: str) -> Iterator[Command]:
    """Yield the commands of one line, without `sudo`, redirections and the comment."""
    parser = shlex.shlex(line, posix=True, punctuation_chars=True)
    parser.whitespace_split = True
    words: list[str] = []
    for word in (*parser, ";"):
        if word and set(word) <= set(";|&") and words:
            yield _command(place, words)
            words = []
        else:
            words.append(word)


def _command(place: str, words: list[str]) -> Command:
    for sign in (">", ">>", "<"):
        if sign in words:
            words = words[: words.index(sign)]
    variables: dict[str, str] = {}
    while words and (words[0] in {"sudo", "env"} or _ASSIGNMENT.match(words[0])):
        name, is_assignment, value = words[0].partition("=")
        if is_assignment:
            variables[name] = value
        words = words[1:]
    return Command(place, variables, tuple(words))
