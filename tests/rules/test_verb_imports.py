"""A verb of `giraff` imports what it needs: every module delays each command that a person types."""

import sys
from typing import Final

from tests.support.tools import finished

_MODULES: Final = {
    "--help": 83,
    "why --help": 9,
    "estop engage --help": 9,
    "completion bash": 10,
    "estop engage": 86,
}
"""Modules of ours, at most; of a stop until it opens its first link."""
_MOST_OF_OTHERS: Final = 150
_MORE_OF_A_STOP: Final = 40
_NOT_NEEDED: Final = {"rich", "zenoh", "asyncio", "msgspec", "numpy", "multiprocessing", "tomllib"}
_NOT_BEFORE_A_STOP: Final = {"rich", "asyncio", "numpy", "multiprocessing", "tomlkit", "ssl", "http", "email", "ctypes"}
_SCRIPT: Final = """
import os, sys
import giraff_cli.start as start
for words in sys.argv[1:]:
    if not os.fork():
        told = os.dup(1)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        def end(*_, **__):
            os.write(told, " ".join(sorted(sys.modules)).encode() + b"\\n")
            os._exit(0)
        start.end = end
        if words == "estop engage":
            import zenoh
            zenoh.open = end
        sys.argv = ["giraff", *words.split()]
        start.main()
    os.wait()
"""


def test_a_verb_imports_no_other_verb() -> None:
    lines = finished([sys.executable, "-I", "-c", _SCRIPT, *_MODULES], check=True).stdout.splitlines()
    for words, line in zip(_MODULES, lines, strict=True):
        modules = line.split()
        not_needed = _NOT_BEFORE_A_STOP if words == "estop engage" else _NOT_NEEDED
        assert {each.partition(".")[0] for each in modules} & not_needed == set(), words
        ours = [each for each in modules if each.startswith("giraff_")]
        assert len(ours) <= _MODULES[words], (words, ours)
        more = _MORE_OF_A_STOP if words == "estop engage" else 0
        assert len(modules) - len(ours) <= _MOST_OF_OTHERS + more, words
        if words not in {"--help", "estop engage"}:
            folders = {each.split(".")[1] for each in ours if each.startswith("giraff_cli.") and each.count(".") > 1}
            assert folders == {words.split()[0]}
