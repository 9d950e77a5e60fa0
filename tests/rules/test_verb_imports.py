"""A verb of `giraff` imports what it needs: every module delays each command that a person types."""

from __future__ import annotations

import sys
from typing import Final

from tests.support.tools import finished

_MODULES: Final = {
    "--help": 84,
    "why --help": 9,
    "estop engage --help": 9,
    "completion bash": 10,
}
"""Modules of ours, at most."""
_MOST_OF_OTHERS: Final = 150
_NOT_NEEDED: Final = {"rich", "zenoh", "asyncio", "msgspec", "numpy", "multiprocessing", "tomllib"}
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
        sys.argv = ["giraff", *words.split()]
        start.main()
    os.wait()
"""


def test_a_verb_imports_no_other_verb() -> None:
    lines = finished([sys.executable, "-I", "-c", _SCRIPT, *_MODULES], check=True).stdout.splitlines()
    for words, line in zip(_MODULES, lines, strict=True):
        modules = line.split()
        assert {each.partition(".")[0] for each in modules} & _NOT_NEEDED == set(), words
        ours = [each for each in modules if each.startswith("giraff_")]
        assert len(ours) <= _MODULES[words], (words, ours)
        assert len(modules) - len(ours) <= _MOST_OF_OTHERS, words
        if words != "--help":
            folders = {each.split(".")[1] for each in ours if each.startswith("giraff_cli.") and each.count(".") > 1}
            assert folders == {words.split()[0]}
