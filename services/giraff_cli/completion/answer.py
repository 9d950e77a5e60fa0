"""Answers a shell that asks what a word of a command line can become. It prints nothing else and raises nothing."""

import contextlib
import io
import re
import threading
import time
from collections.abc import Iterable, Sequence
from typing import Any, Final

_WITHIN: Final = 0.5  # s for all that the network is asked
_SAFE: Final = re.compile(r"[A-Za-z0-9_./*@+-]+")
"""Candidates that any shell takes as they are. A stranger on the network may have names with other letters."""
_SOURCES: Final = {
    ("topic", "key"): "published",
    ("record", "topics"): "published",
    ("play", "topics"): "topics",
    ("param", "name"): "params",
    ("param", "names"): "params",
    ("node", "service"): "services",
    ("go", "goal"): "files",
    **dict.fromkeys((("stop", "robots"), ("estop", "robots")), "robots"),
}
"""By verb and parameter: what its values are. A robot is one wherever it is asked for."""

_NARROWER: Final = {("pub", "published"): "topics", ("set", "params"): "settable"}
"""By the verb's last word, and by what a word would be after any other."""
_FILES: Final = {"path", "file", "directory", "filename"}
"""Typer's names for types of files."""

Candidate = tuple[str, str]
"""A word, and what it is for."""
_SHELLS_FILES: Final[Candidate] = ("", "file")
"""Stands for the shell's own files."""


def print_candidates(command: Any, words: Sequence[str]) -> None:
    """Print what the last of these words can become: a line each."""
    with contextlib.redirect_stderr(io.StringIO()), contextlib.suppress(Exception):
        for word, help_ in candidates(command, words):
            print(word, " ".join(help_.split()), sep="\t")


def candidates(command: Any, words: Sequence[str]) -> list[Candidate]:
    """Return what the last word can become."""
    from typer._click.shell_completion import _resolve_context, _resolve_incomplete  # noqa: PLC0415

    *before, last = [_unquoted(word) for word in words] or [""]
    before = [word for word in before if word != "="]  # bash gives it as a word
    context = _resolve_context(command, {}, "giraff", before)
    wanted, word = _resolve_incomplete(context, before, last)
    joined = last[: len(last) - len(word)] if last.startswith("--") else ""  # --robot=NAME is one word to zsh
    if (found := _of_robot(context, wanted, word)) is None:
        if hasattr(wanted, "commands") and context._protected_args:  # noqa: SLF001  no such verb
            return []
        if getattr(getattr(wanted, "type", None), "name", "") in _FILES:
            return [_SHELLS_FILES]
        found = [(str(item.value), item.help or "") for item in wanted.shell_complete(context, word)]
    return [(joined + each, help_) for each, help_ in found if each.startswith(word) and each.isprintable()]


def _unquoted(word: str) -> str:
    return re.sub(r"\\(.)|[\"']", r"\1", word)


def _of_robot(context: Any, wanted: Any, word: str) -> list[Candidate] | None:
    """Return what a robot has of it; None: a robot does not say what it can be."""
    path = context.command_path.split()[1:]
    source = "robots" if wanted.name == "robot" else _SOURCES.get((path[0] if path else "", wanted.name))
    if source is None or not hasattr(wanted, "param_type_name"):
        return None
    if source == "files":
        return [_SHELLS_FILES]
    source = _NARROWER.get((path[-1], source), source)
    from giraff_cli.completion import sources  # noqa: PLC0415

    found = _within(source, context.params, word) if source != "topics" else []
    return [(each, "") for each in sources.by_service(source, found or sources.known(source, word), word)]


def _within(source: str, typed: dict[str, Any], word: str) -> list[str]:
    """Return what the network says within half a second; what cannot be a plain word is left out."""
    found: list[str] = []

    def ask() -> None:
        from giraff_cli.completion.sources import asked  # noqa: PLC0415

        with contextlib.suppress(Exception):
            found.extend(asked(source, typed.get("robot"), typed.get("connect") or (), word, deadline))

    deadline = time.monotonic() + _WITHIN
    asking = threading.Thread(target=ask, daemon=True)
    asking.start()
    asking.join(_WITHIN)
    return plain_words(list(found))


def plain_words(found: Iterable[str]) -> list[str]:
    """Return each word once that a shell takes as it is, and that is no option."""
    return sorted({word for word in found if _SAFE.fullmatch(word) and not word.startswith("-")})
